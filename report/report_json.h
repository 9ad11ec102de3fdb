// report.json.
#pragma once

#include <nlohmann/json.hpp>

#include "report/report.h"

namespace bodyopt {

nlohmann::ordered_json report_json(const ReportData& data);

// {"rms", "p99", "max", "jitter"}, mm.
nlohmann::ordered_json errors_json(const MethodReport& method);
// Errors, bytes, coefficients and seconds; neither its name nor its frames.
nlohmann::ordered_json figures_json(const MethodReport& method);

}  // namespace bodyopt
