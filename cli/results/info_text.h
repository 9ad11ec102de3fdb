// What `info` found, for people.
#pragma once

#include <string>

#include "cli/arguments/common.h"

namespace bodyopt::cli {

// A line per entry, then the tables. What is long within an entry is only counted: JSON has it whole.
std::string info_text(const Json& result);

}  // namespace bodyopt::cli
