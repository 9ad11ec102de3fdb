// report.html, as text.
#pragma once

#include <string>

#include "report/report.h"

namespace bodyopt {

std::string report_page(const ReportData& data);

}  // namespace bodyopt
