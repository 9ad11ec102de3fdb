// report.json.
#pragma once

#include "report/report.h"

namespace bodyopt {

Json report_json(const ReportData& data);

}  // namespace bodyopt
