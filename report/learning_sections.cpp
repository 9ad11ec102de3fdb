// What was learned, of what, and at which cost.
#include <algorithm>
#include <cmath>

#include "report/plots.h"
#include "report/report_sections.h"
#include "report/trade_off_plot.h"

namespace bodyopt {
namespace {

// Regions that keep much more than the skin as a whole, and a notable part of their own motion; worst first.
std::vector<RegionReport> unexplained(const ReportData& data) {
  constexpr double kOfWhole = 1.5, kOfMotion = 0.05;
  constexpr std::size_t kMost = 5;
  std::vector<RegionReport> found;
  for (const RegionReport& region : data.regions) {
    const bool much =
        region.left_mm >= kOfWhole * data.expected_rms_mm && region.left_mm >= kOfMotion * region.moves_mm;
    if (much) found.push_back(region);
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const RegionReport& a, const RegionReport& b) { return a.left_mm > b.left_mm; });
  if (found.size() > kMost) found.resize(kMost);
  return found;
}

Cell cell_or_dash(const std::optional<double>& value) { return value ? number_cell(*value) : Cell{"-", {}}; }

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

TradeOffPlot plot_of(const ReportData& data) {
  TradeOffPlot plot;
  plot.curve = data.trade_off;
  plot.chosen.bytes_per_vertex = data.bytes_per_vertex;
  plot.chosen.expected_mm = data.expected_rms_mm;
  if (!data.methods.empty()) plot.heldout_mm = data.methods.back().errors.rms;
  return plot;
}

}  // namespace

void add_regions(const ReportData& data, Page& page) {
  if (data.regions.empty()) return;
  page.heading("Regions of the skin");
  Table table;
  table.columns = {{"region"}, {"moves, mm"}, {"left by cross-validation, mm"}};
  if (data.coverage) {
    table.columns.push_back({"expected on held-out frames, mm"});
    table.columns.push_back({"true on held-out frames, mm"});
  }
  for (const RegionReport& region : data.regions) {
    std::vector<Cell>& row = table.rows.emplace_back();
    row = {{std::to_string(table.rows.size()) + ". " + region.name, {}},
           number_cell(region.moves_mm),
           number_cell(region.left_mm)};
    if (!data.coverage) continue;
    row.push_back(cell_or_dash(region.expected_mm));
    row.push_back(cell_or_dash(region.true_mm));
  }
  if (data.region_picture) {
    const std::string labels[] = {"from the front", "from behind"};
    page.picture(*data.region_picture, labels, "The regions in which the skin is learned", "Numbered as below.", "");
  }
  page.table(table);
  page.paragraph(
      "RMS over the vertices of a region: how far it moves beyond Direct Delta Mush in the training frames, and how "
      "much of that stays unexplained in frames that cross-validation held out. A dash: the basis keeps nothing of the "
      "region, because it is not worth its bytes.");
  for (const RegionReport& region : unexplained(data)) {
    page.paragraph("The skin at " + region.name + " moves " + millimetres(region.moves_mm) +
                   ", of which nothing explains " + millimetres(region.left_mm) + ": a muscle there may help.");
  }
}

void add_muscles(const ReportData& data, Page& page) {
  if (data.muscles.empty()) return;
  constexpr std::size_t kShown = 20;
  page.heading("What the muscles explain");
  std::vector<Bar> bars;
  std::vector<std::string> useless;
  for (const MuscleReport& muscle : data.muscles) {
    if (!(muscle.percent > 0)) {
      useless.push_back(muscle.name);
    } else if (bars.size() < kShown) {
      bars.push_back({muscle.name, "#e8837a", muscle.percent, number_text(muscle.percent) + " %"});
    }
  }
  const std::size_t more = data.muscles.size() - useless.size() - bars.size();
  page.chart(bar_chart(bars),
             "Part of the un-posed motion of the training frames that the strains of a muscle explain beyond what was "
             "chosen before them" +
                 (more > 0 ? "; " + plural(more, "muscle") + " with less not shown." : std::string(".")));
  if (!useless.empty()) {
    page.paragraph("Of no use to the basis, no region listens to them (" + std::to_string(useless.size()) +
                   "): " + joined(useless) + ".");
  }
}

void add_flexed(const ReportData& data, Page& page) {
  if (!data.flexed) return;
  constexpr std::size_t kNamed = 6;
  const FlexReport& flexed = *data.flexed;
  page.heading("What flexing does");
  std::vector<std::string> controls;
  for (const auto& [name, value] : flexed.controls) {
    if (controls.size() < kNamed) controls.push_back(name + " " + number_text(value, 2));
  }
  const std::size_t more = flexed.controls.size() - controls.size();
  const std::string labels[] = {"at rest", "flexed", "what flexing moves"};
  page.picture(flexed.image, labels,
               "The most that is flexed: frame " + std::to_string(flexed.frame) + " of take '" + flexed.take + "'",
               "The learned skin in one pose, seen from where flexing moves it most, by " + millimetres(flexed.max_mm) +
                   ": " + joined(controls) + (more > 0 ? " and " + plural(more, "control") + " more." : "."),
               colour_bar(flexed.heat_scale_mm));
}

void add_unposing(const ReportData& data, Page& page) {
  page.heading("What is left to learn");
  const Bar bars[] = {
      {"after un-posing by LBS", "#8a92a1", data.unposing_residual_mm.lbs, millimetres(data.unposing_residual_mm.lbs)},
      {"after un-posing by DDM", "#62aee8", data.unposing_residual_mm.ddm, millimetres(data.unposing_residual_mm.ddm)}};
  page.chart(bar_chart(bars),
             "Over the training frames: RMS of the displacement between the true shape, taken back to the rest pose, "
             "and the rest shape: the smaller it is, the less a residual has to carry.");
}

void add_trade_off(const ReportData& data, Page& page) {
  if (data.trade_off.size() < 2) return;
  page.heading("Bytes against millimetres");
  page.chart(trade_off_plot(plot_of(data)),
             "Bases that this training could have given (train --budget, --tolerance), by their bytes per vertex: the "
             "RMS error that cross-validation on the training frames expects.");
  Table table;
  table.columns = {
      {"bytes per vertex"}, {"expected RMS, mm"}, {"coefficients"}, {"a frame on one core, us (estimate)"}};
  for (const TradeOffPoint& point : data.trade_off) {
    table.rows.push_back({{std::to_string(std::lround(point.bytes_per_vertex)), {}},
                          number_cell(point.expected_mm),
                          number_cell(point.coefficients),
                          number_cell(point.microseconds)});
  }
  page.table(table);
}

}  // namespace bodyopt
