// How well it does on each held-out take, by area and by part of the body.
#include <algorithm>

#include "report/report_sections.h"

namespace bodyopt {
namespace {

// Of Direct Delta Mush's error, how much is left.
double ratio_of(const AreaErrorsReport& errors) { return errors.ddm_mm > 0 ? errors.full_mm / errors.ddm_mm : 0; }

std::vector<TakeReport::Part> by_ratio(std::vector<TakeReport::Part> parts) {
  std::stable_sort(parts.begin(), parts.end(), [](const TakeReport::Part& a, const TakeReport::Part& b) {
    return ratio_of(a.errors) > ratio_of(b.errors);
  });
  return parts;
}

Table table_of(const ReportData& data) {
  Table table;
  table.columns = {{"take and part"}, {"frames"},         {"area, cm\u00b2"}, {"DDM, mm"},
                   {"learned, mm"},   {"of DDM's error"}, {"expected, mm"},   {"rho"}};
  for (const TakeReport& take : data.takes) {
    const auto add = [&](const std::string& name, const AreaErrorsReport& errors, Cell frames, Cell area, Cell rho) {
      table.rows.push_back({{name, {}},
                            std::move(frames),
                            std::move(area),
                            number_cell(errors.ddm_mm),
                            number_cell(errors.full_mm),
                            number_cell(ratio_of(errors)),
                            number_cell(errors.expected_mm),
                            std::move(rho)});
    };
    double area = 0;
    for (const TakeReport::Part& part : take.parts) area += part.area_m2;
    add(take.name + (take.foreign ? "" : " (between trained frames)"), take.errors, number_cell(take.frames),
        number_cell(1e4 * area), take.rank_correlation ? number_cell(*take.rank_correlation) : Cell{"", {}});
    for (const TakeReport::Part& part : by_ratio(take.parts)) {
      add("\u2003" + part.name, part.errors, {"", {}}, number_cell(1e4 * part.area_m2), {"", {}});
    }
  }
  return table;
}

}  // namespace

void add_takes(const ReportData& data, Page& page) {
  if (data.takes.empty()) return;
  const bool foreign = std::any_of(data.takes.begin(), data.takes.end(), [](const auto& take) { return take.foreign; });
  page.heading(foreign ? "On motion that shares nothing with what was trained on" : "Between the frames trained on");
  page.table(table_of(data));
  page.paragraph(
      "RMS over the held-out frames by area of the skin, so that fine meshes of head and hands do not count for more "
      "than they cover; below each take the skin of every joint, those that gained least first. Expected is what the "
      "basis says of itself without the truth, rho how alike it ranks frames and parts with it (Spearman).");
  if (!foreign) {
    page.paragraph(
        "All held-out frames are of takes that were trained on: this says how well poses are interpolated, not how a "
        "shot will look. Hold out a whole take of a shot to see that.");
  }
}

}  // namespace bodyopt
