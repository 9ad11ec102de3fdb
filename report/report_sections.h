// The sections of report.html, in the order of the page. What has nothing to say adds nothing.
#pragma once

#include "report/html.h"
#include "report/report.h"

namespace bodyopt {

// errors_sections.cpp
void add_summary(const ReportData& data, Page& page);
void add_pictures(const ReportData& data, Page& page);
void add_methods(const ReportData& data, Page& page);
void add_curves(const ReportData& data, Page& page);
// takes_section.cpp
void add_takes(const ReportData& data, Page& page);
// learning_sections.cpp
void add_regions(const ReportData& data, Page& page);
void add_muscles(const ReportData& data, Page& page);
void add_flexed(const ReportData& data, Page& page);
void add_unposing(const ReportData& data, Page& page);
void add_trade_off(const ReportData& data, Page& page);
// coverage_section.cpp
void add_coverage(const ReportData& data, Page& page);
// jiggle_section.cpp
void add_jiggle(const ReportData& data, Page& page);
// details_sections.cpp
void add_warnings(const ReportData& data, Page& page);
void add_details(const ReportData& data, Page& page);
void add_provenance(const ReportData& data, Page& page);

// Wording that they share.
std::string plural(std::size_t count, const std::string& thing);  // "1 frame", "2 frames"
std::string millimetres(double value);
Cell number_cell(double value);

}  // namespace bodyopt
