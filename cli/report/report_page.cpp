#include "cli/report/report_page.h"

#include <array>
#include <cmath>

#include "cli/report/html.h"
#include "cli/report/plots.h"

namespace bodyopt {
namespace {

struct Method {
  const MethodReport& report;
  const char *name, *colour, *meaning;
};

std::array<Method, 4> methods_of(const ReportData& data) {
  return {
      {{data.lbs, "LBS", "#8a92a1", "Linear blend skinning: the skin weights alone, where every rig starts."},
       {data.ddm, "DDM", "#62aee8", "Direct Delta Mush: smooth skinning from the same weights; nothing is learned."},
       {data.linear, "Linear", "#b892f2",
        "DDM plus linear correctives driven by the joints alone, the best of them within the bytes of Full."},
       {data.full, "Full", "#f2b866",
        "DDM plus what was learned from the simulation, driven by joints and muscle strains: what Bodyopt runs."}}};
}

std::string count_of(std::size_t count, const std::string& thing) {
  return std::to_string(count) + " " + thing + (count == 1 ? "" : "s");
}

std::string millimetres(double value) { return number_text(value) + " mm"; }

std::string seconds_text(double seconds) {
  if (seconds < 90) return number_text(seconds) + " s";
  const long whole = std::lround(seconds);
  return std::to_string(whole / 60) + " min " + std::to_string(whole % 60) + " s";
}

// How much smaller (or larger) the error of `full` is than another method's.
Headline compare(const ReportData& data, const MethodReport& other, const std::string& name) {
  const double full = data.full.rms;
  const std::string of = " error than " + name + " (" + millimetres(other.rms) + ")";
  if (!(full > 0)) return {"0", "mm", "of error, where " + name + " has " + millimetres(other.rms)};
  const auto times = [](double ratio) { return number_text(ratio, ratio < 2 ? 3 : 2); };
  if (other.rms >= full) return {times(other.rms / full), "times", "smaller RMS" + of};
  return {times(full / std::max(other.rms, 1e-12)), "times", "larger RMS" + of};
}

void add_summary(const ReportData& data, Page& page) {
  const std::string tissue = data.character.muscles > 0
                                 ? "The tissue and the " + count_of(data.character.muscles, "muscle")
                                 : std::string("The tissue");
  page.paragraph(tissue + " of this character were simulated for " + count_of(data.dataset.train_frames, "frame") +
                 " of training motion. Bodyopt learned from those frames what the skin does beyond Direct Delta Mush, "
                 "and was then given " +
                 count_of(data.dataset.heldout_frames, "frame") +
                 " of motion it had not seen. The errors on this page are measured on these held-out frames, against "
                 "the simulation, after the root's translation is taken out; where a figure is of the training frames, "
                 "it says so.");
  if (data.quick) {
    page.paragraph("This is a quick run on a few of the frames: it shows that everything works, not how well.");
  }
  const Headline headlines[] = {{number_text(data.full.rms), "mm",
                                 "RMS error on the held-out frames; 99 % of the points within " +
                                     millimetres(data.full.p99) + ", the worst " + millimetres(data.full.max)},
                                compare(data, data.ddm, "DDM alone"),
                                compare(data, data.linear, "linear correctives of equal size"),
                                {number_text(data.bytes_per_vertex), "bytes", "per vertex, all tables that run"}};
  page.headlines(headlines);
}

void add_pictures(const ReportData& data, Page& page) {
  if (data.pictures.empty()) return;
  page.heading("Held-out poses: simulation, result, and where they differ");
  page.paragraph(
      "Left the simulation, in the middle the learned skin, right the learned skin coloured by its distance from the "
      "simulation: clay where they agree, dark magenta where they are as far apart as the colour bar says or more.");
  const std::string labels[] = {"simulation (truth)", "Bodyopt (result)", "distance"};
  for (const PictureReport& picture : data.pictures) {
    const std::string title = picture.kind == "worst"    ? "The worst held-out frame, "
                              : picture.kind == "median" ? "The median held-out frame, "
                                                         : "A chosen pose, frame ";
    const std::string caption = "RMS " + millimetres(picture.rms_mm) + ", largest " + millimetres(picture.max_mm) +
                                (picture.caption.empty() ? "" : ": " + picture.caption) + ".";
    page.picture(picture.image, labels, title + std::to_string(picture.frame), caption,
                 colour_bar(picture.heat_scale_mm));
  }
}

LinePlot curves(const ReportData& data, const std::string& label, std::vector<double> MethodReport::*values) {
  LinePlot plot{"held-out frame", label, data.heldout_frame_numbers, {}};
  for (const Method& method : methods_of(data)) {
    plot.series.push_back({method.name, method.colour, method.report.*values, &method.report == &data.full});
  }
  return plot;
}

void add_curves(const ReportData& data, Page& page) {
  if (data.heldout_frame_numbers.empty()) return;
  page.heading("Error of every held-out frame");
  page.chart(line_plot(curves(data, "RMS error, mm", &MethodReport::frame_rms)),
             "RMS over all vertices of each held-out frame, in millimetres, on a logarithmic scale.");
  page.chart(line_plot(curves(data, "largest error, mm", &MethodReport::frame_max)),
             "The worst vertex of each held-out frame, in millimetres, on a logarithmic scale.");
}

void add_methods(const ReportData& data, Page& page) {
  page.heading("The methods, on the held-out frames");
  std::vector<Bar> bars;
  Table table;
  table.columns = {{"method"},
                   {"RMS, mm", true},
                   {"99th percentile, mm", true},
                   {"largest, mm", true},
                   {"jitter, mm", true},
                   {"bytes per vertex"},
                   {"coefficients"},
                   {"what it is"}};
  const auto number = [](double value) { return Cell{number_text(value), value}; };
  for (const Method& method : methods_of(data)) {
    const MethodReport& r = method.report;
    bars.push_back({method.name, method.colour, r.rms, millimetres(r.rms)});
    table.rows.push_back({{method.name, {}},
                          number(r.rms),
                          number(r.p99),
                          number(r.max),
                          number(r.jitter),
                          number(r.bytes_per_vertex),
                          number(r.coefficients),
                          {method.meaning, {}}});
  }
  page.chart(bar_chart(bars), "RMS error over all held-out frames. Shorter is better.");
  page.table(table);
  page.paragraph(
      "Jitter is the RMS second difference of the error over consecutive held-out frames: what is seen as popping. The "
      "best "
      "value of each column of errors is highlighted. Nothing was tuned on the held-out frames.");
}

void add_trade_off(const ReportData& data, Page& page) {
  if (data.trade_off.empty()) return;
  page.heading("Bytes against millimetres");
  std::vector<Bar> bars;
  for (const TradeOffReport& point : data.trade_off) {
    const std::string bytes = std::to_string(std::lround(point.bytes_per_vertex)) + " bytes, ";
    bars.push_back({bytes + std::to_string(std::lround(point.microseconds)) + " us", "#f2b866", point.expected_rms_mm,
                    millimetres(point.expected_rms_mm)});
  }
  page.chart(
      bar_chart(bars),
      "Bases that this training could have given, by their bytes per vertex: the RMS error that cross-validation "
      "on the training frames expects, and an estimate of a frame's time on one core.");
}

void add_unposing(const ReportData& data, Page& page) {
  page.heading("What is left to learn");
  const Bar bars[] = {
      {"after un-posing by LBS", "#8a92a1", data.unposing_residual_mm.lbs, millimetres(data.unposing_residual_mm.lbs)},
      {"after un-posing by DDM", "#62aee8", data.unposing_residual_mm.ddm, millimetres(data.unposing_residual_mm.ddm)}};
  page.chart(bar_chart(bars),
             "Over the training frames: RMS of the displacement between the simulated shape, taken back to the rest "
             "pose, and the rest shape: the "
             "smaller it is, the less a residual has to carry.");
}

void add_details(const ReportData& data, Page& page) {
  page.heading("Details");
  Table table;
  table.columns = {{"what"}, {"value"}};
  const auto row = [&](const std::string& what, const std::string& value) {
    table.rows.push_back({{what, {}}, {value, {}}});
  };
  const auto& box = data.character.bounding_box_m;
  row("character", data.character.name + ": " + std::to_string(data.character.vertices) + " vertices" + ", " +
                       count_of(data.character.joints, "joint") + ", " + count_of(data.character.muscles, "muscle") +
                       "; " + number_text(box[0]) + " x " + number_text(box[1]) + " x " + number_text(box[2]) + " m");
  row("training frames", std::to_string(data.dataset.train_frames));
  row("held-out frames", std::to_string(data.dataset.heldout_frames));
  row("frames left out", std::to_string(data.dataset.unconverged) + " whose simulation did not converge");
  if (data.simulation) {
    const SimulationReport& s = *data.simulation;
    row("simulation", std::to_string(s.converged) + " of " + count_of(s.frames, "frame") +
                          " converged; force left over, relative to the elastic forces: median " +
                          number_text(s.median_residual, 2) + ", worst " + number_text(s.worst_residual, 2) +
                          "; on average " + number_text(s.mean_iterations) + " iterations a frame");
    row("draft of the held-out motion", "in " + seconds_text(data.seconds.draft) + ", " + millimetres(s.draft_rms_mm) +
                                            " RMS from the simulation, " + millimetres(s.draft_max_mm) + " at most");
  }
  std::string stages;
  for (const auto& [stage, bytes] : data.bytes_by_stage) {
    stages += (stages.empty() ? ": " : ", ") + stage + " " + number_text(bytes / 1024) + " KiB";
  }
  row("tables", number_text(data.bytes_per_vertex) + " bytes per vertex" + stages);
  row("evaluated on", data.device);
  row("GPU against CPU", "at most " + number_text(1e6 * data.cpu_gpu_max_difference_m) +
                             " micrometres apart, over all held-out frames and vertices");
  row("time", "character " + seconds_text(data.seconds.build_character) + ", simulation " +
                  seconds_text(data.seconds.simulate) + ", training " + seconds_text(data.seconds.train) +
                  ", evaluation of the held-out frames " + seconds_text(data.seconds.eval));
  row("peak memory", number_text(data.peak_memory_mib) + " MiB");
  page.table(table);
}

}  // namespace

std::string report_page(const ReportData& data) {
  Page page("How the skin of " + (data.character.name.empty() ? "the character" : data.character.name) + " moves",
            "Bodyopt: learned from a muscle simulation, measured on " +
                count_of(data.dataset.heldout_frames, "held-out frame"));
  add_summary(data, page);
  add_pictures(data, page);
  add_methods(data, page);
  add_curves(data, page);
  add_trade_off(data, page);
  add_unposing(data, page);
  add_details(data, page);
  return page.text();
}

}  // namespace bodyopt
