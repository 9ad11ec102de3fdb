// report.json.
#pragma once

#include <nlohmann/json.hpp>

#include "report/report.h"

namespace bodyopt {

nlohmann::ordered_json report_json(const ReportData& data);

}  // namespace bodyopt
