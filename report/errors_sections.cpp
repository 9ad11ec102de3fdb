// How far the skin is from the truth on the held-out frames.
#include <algorithm>

#include "report/plots.h"
#include "report/report_sections.h"

namespace bodyopt {
namespace {

constexpr const char *kLbsColour = "#8a92a1", *kDdmColour = "#62aee8", *kLinearColour = "#b892f2",
                     *kFullColour = "#f2b866", *kOtherColour = "#59606d";

// Of the linear correctives, those with the smallest error; null where there are none.
const MethodResult* best_linear(const ReportData& data) {
  const MethodResult* best = nullptr;
  for (const MethodResult& method : data.methods) {
    if (method.name.find(", linear") == std::string::npos) continue;
    if (best == nullptr || method.errors.rms < best->errors.rms) best = &method;
  }
  return best;
}

const char* colour_of(const ReportData& data, const MethodResult& method) {
  if (&method == &data.methods.back()) return kFullColour;
  if (&method == data.methods.data()) return kLbsColour;
  if (&method == data.methods.data() + 1) return kDdmColour;
  return &method == best_linear(data) ? kLinearColour : kOtherColour;
}

// How much smaller (or larger) the error of what was trained is than another method's.
Headline compare(const ReportData& data, const MethodResult& other, const std::string& name) {
  const double full = data.methods.back().errors.rms;
  const std::string of = " error than " + name + " (" + millimetres(other.errors.rms) + ")";
  if (!(full > 0)) return {"0", "mm", "of error, where " + name + " has " + millimetres(other.errors.rms)};
  const auto times = [](double ratio) { return number_text(ratio, ratio < 2 ? 3 : 2); };
  if (other.errors.rms >= full) return {times(other.errors.rms / full), "times", "smaller RMS" + of};
  return {times(full / std::max(other.errors.rms, 1e-12)), "times", "larger RMS" + of};
}

void add_headlines(const ReportData& data, Page& page) {
  std::vector<Headline> headlines;
  if (!data.methods.empty()) {
    const MethodResult& full = data.methods.back();
    headlines.push_back({number_text(full.errors.rms), "mm",
                         "RMS error on the held-out frames; 99 % of the points within " + millimetres(full.errors.p99) +
                             ", the worst " + millimetres(full.errors.max)});
    headlines.push_back(compare(data, data.methods[1], "DDM alone"));
    if (const MethodResult* linear = best_linear(data)) {
      headlines.push_back(compare(data, *linear, "linear correctives of equal size"));
    }
  } else {
    headlines.push_back({number_text(data.expected_rms_mm), "mm",
                         "RMS error that cross-validation expects of poses like the training frames"});
  }
  headlines.push_back({number_text(data.bytes_per_vertex), "bytes", "per vertex, all tables that run"});
  page.headlines(headlines);
}

LinePlot curves(const ReportData& data, const std::string& label, std::vector<double> ErrorStatistics::*values) {
  LinePlot plot{"held-out frame", label, data.heldout, {}};
  const MethodResult* linear = best_linear(data);
  for (std::size_t m = 0; m < data.methods.size(); ++m) {
    const MethodResult& method = data.methods[m];
    const bool last = m + 1 == data.methods.size();
    if (m < 2 || last || &method == linear) {
      plot.series.push_back({method.name, colour_of(data, method), method.errors.*values, last});
    }
  }
  return plot;
}

void add_mean_error(const ReportData& data, Page& page) {
  const MeanErrorReport& mean = *data.mean_error;
  const std::string labels[] = {"from the front", "from behind"};
  page.picture(mean.image, labels, "Mean error of every point over the held-out frames",
               "On the rest skin: where it is wrong, on average over " +
                   plural(data.heldout.frames.size(), "held-out frame") + "; " + millimetres(mean.largest_mm) +
                   " at the worst point.",
               colour_bar(mean.heat_scale_mm));
}

}  // namespace

void add_summary(const ReportData& data, Page& page) {
  const std::string muscles = data.character.muscles > 0 ? ", with " + plural(data.character.muscles, "muscle") : "";
  page.paragraph("Bodyopt learned from " + plural(data.dataset.train_frames, "frame") +
                 " what the skin of this character" + muscles + ", does beyond Direct Delta Mush (DDM).");
  if (data.methods.empty()) {
    page.paragraph(
        "The dataset holds out no frames, so nothing here is measured on motion that was not trained on: errors, "
        "pictures and the expected errors of held-out frames are missing: " +
        data.dataset.how_to_hold_out + ".");
  } else {
    page.paragraph(
        "It was then given " + plural(data.dataset.heldout_frames, "frame") +
        " that it had not seen. The errors on this page are measured on these held-out frames, against their "
        "true shapes, after the root's translation is taken out; where a figure is of the training frames, "
        "it says so.");
  }
  if (data.demo && data.demo->quick) {
    page.paragraph("This is a quick run on a few of the frames: it shows that everything works, not how well.");
  }
  add_headlines(data, page);
}

void add_pictures(const ReportData& data, Page& page) {
  if (data.methods.empty()) return;
  page.heading("Held-out poses: truth, Direct Delta Mush, result, and where it differs");
  if (data.pictures.empty()) {
    page.paragraph("There are no pictures: they need a Vulkan device, and none was found (or the CPU was asked for).");
    return;
  }
  page.paragraph(
      "From left to right: the true shape, Direct Delta Mush alone, the learned skin, and the learned skin coloured by "
      "its distance from the truth: clay where they agree, dark magenta where they are as far apart as the colour bar "
      "says or more.");
  const std::string labels[] = {"truth", "Direct Delta Mush", "Bodyopt (result)", "distance"};
  for (const PictureReport& picture : data.pictures) {
    const std::string title = picture.kind == "worst"    ? "The worst: held-out frame "
                              : picture.kind == "median" ? "The median: held-out frame "
                                                         : "A chosen pose: held-out frame ";
    const std::string caption = "RMS " + millimetres(picture.rms_mm) + ", largest " + millimetres(picture.max_mm) +
                                (picture.caption.empty() ? "" : ": " + picture.caption) + ".";
    const std::string of_take = data.heldout.takes.size() > 1 ? " of take '" + picture.take + "'" : "";
    page.picture(picture.image, labels, title + std::to_string(picture.frame) + of_take, caption,
                 colour_bar(picture.heat_scale_mm));
  }
  if (data.mean_error) add_mean_error(data, page);
}

void add_methods(const ReportData& data, Page& page) {
  if (data.methods.empty()) return;
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
                   {"training, s"}};
  for (const MethodResult& method : data.methods) {
    bars.push_back({method.name, colour_of(data, method), method.errors.rms, millimetres(method.errors.rms)});
    table.rows.push_back({{method.name, {}},
                          number_cell(method.errors.rms),
                          number_cell(method.errors.p99),
                          number_cell(method.errors.max),
                          number_cell(method.errors.jitter),
                          number_cell(method.bytes_per_vertex),
                          number_cell(method.coefficients),
                          number_cell(method.seconds)});
  }
  page.chart(bar_chart(bars), "RMS error over all held-out frames. Shorter is better.");
  page.table(table);
  page.paragraph(
      "LBS is linear blend skinning, where every rig starts; DDM is Direct Delta Mush, smooth skinning from the same "
      "weights. Neither learns. Jitter is the RMS second difference of the error over consecutive held-out frames: "
      "what "
      "is seen as popping. The best value of each column of errors is highlighted. Nothing was tuned on the held-out "
      "frames.");
  if (data.methods.size() > 3) {
    page.paragraph(
        "The others were trained on the same frames and may have as many bytes as the last: what they un-pose with, "
        "what drives them (joints, or joints and muscle strains), by linear maps or kernels, and where: dense (the "
        "whole skin together), local or static (regions by skin weights), dynamic (regions by what muscles do, too). "
        "LBS with linear maps of joints is what SMPL (dense) and STAR (local) do, with kernels what the deformers of "
        "animation packages do.");
  }
}

void add_curves(const ReportData& data, Page& page) {
  if (data.methods.empty()) return;
  page.heading("Error of every held-out frame");
  page.chart(line_plot(curves(data, "RMS error, mm", &ErrorStatistics::frame_rms)),
             "RMS over all vertices of each held-out frame, in millimetres, on a logarithmic scale.");
  page.chart(line_plot(curves(data, "largest error, mm", &ErrorStatistics::frame_max)),
             "The worst vertex of each held-out frame, in millimetres, on a logarithmic scale.");
}

}  // namespace bodyopt
