// How well the basis knows the poses of the held-out frames.
#include <algorithm>
#include <map>

#include "report/heat_strip.h"
#include "report/plots.h"
#include "report/report_sections.h"

namespace bodyopt {
namespace {

// "take 'walk': 12, 40; take 'run': 7", in the order of the frames.
std::string frame_list(const FrameAxis& axis, std::vector<std::size_t> columns) {
  std::sort(columns.begin(), columns.end());
  std::string text, last;
  for (const std::size_t column : columns) {
    std::string take;
    for (const TakeStart& start : axis.takes) {
      if (start.column <= column) take = start.name;
    }
    if (text.empty() || take != last) {
      text += (text.empty() ? "" : "; ") + (take.empty() ? "" : "take '" + take + "': ");
    } else {
      text += ", ";
    }
    text += std::to_string(axis.frames[column]);
    last = take;
  }
  return text;
}

}  // namespace

void add_coverage(const ReportData& data, Page& page) {
  if (!data.coverage) return;
  const CoverageReport& coverage = *data.coverage;
  page.heading("Expected errors: what the basis does not know");
  page.chart(heat_strip({data.heldout, coverage.frame_mm, coverage.regions, coverage.region_mm}),
             "The error to expect of every held-out frame, by how far its pose is from what was learned, without "
             "looking at its shape: over the whole skin on top, then in every region.");
  const ErrorStatistics& full = data.methods.back().errors;
  page.chart(
      line_plot({"held-out frame",
                 "RMS error, mm",
                 data.heldout,
                 {{"true", "#f2b866", full.frame_rms, true}, {"expected", "#62aee8", coverage.frame_mm, false}}}),
      "Expected and true RMS error of every held-out frame.");
  const std::string alike = coverage.rank_correlation
                                ? " The frames' expected and true errors rank alike with Spearman's rho " +
                                      number_text(*coverage.rank_correlation) + " (1: in the same order; 0: in none)."
                                : std::string();
  page.paragraph("Over all held-out frames " + millimetres(coverage.rms_mm) + " RMS are expected; it is " +
                 millimetres(full.rms) + "." + alike);
  page.paragraph("Of these frames it would help most to simulate and to train on: " +
                 frame_list(data.heldout, coverage.worth_simulating) +
                 ". (Frames that are held out teach nothing; bodyopt coverage lists those of a shot.)");
}

}  // namespace bodyopt
