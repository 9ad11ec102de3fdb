#include "report/report_page.h"

#include "report/plots.h"
#include "report/report_sections.h"

namespace bodyopt {

std::string plural(std::size_t count, const std::string& thing) {
  return std::to_string(count) + " " + thing + (count == 1 ? "" : "s");
}

std::string millimetres(double value) { return number_text(value) + " mm"; }

Cell number_cell(double value) { return {number_text(value), value}; }

std::string report_page(const ReportData& data) {
  Page page("How the skin of " + (data.character.name.empty() ? "the character" : data.character.name) + " moves",
            "Bodyopt: learned from " + plural(data.dataset.train_frames, "frame") + ", measured on " +
                plural(data.dataset.heldout_frames, "held-out frame"));
  add_summary(data, page);
  add_warnings(data, page);
  add_takes(data, page);
  add_pictures(data, page);
  add_methods(data, page);
  add_curves(data, page);
  add_jiggle(data, page);
  add_regions(data, page);
  add_muscles(data, page);
  add_flexed(data, page);
  add_coverage(data, page);
  add_trade_off(data, page);
  add_unposing(data, page);
  add_details(data, page);
  add_provenance(data, page);
  return page.text();
}

}  // namespace bodyopt
