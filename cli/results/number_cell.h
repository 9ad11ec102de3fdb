// Numbers in tables that are sorted by them.
#pragma once

#include "cli/arguments/common.h"
#include "report/html.h"

namespace bodyopt::cli {

inline Cell number_of(const char* pattern, double value) { return {format(pattern, value), value}; }

}  // namespace bodyopt::cli
