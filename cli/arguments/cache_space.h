// The options of verbs that write caches for other programs: in which unit, and which axis is up.
#pragma once

#include "assets/pc2.h"
#include "cli/arguments/common.h"

namespace bodyopt::cli {

// --unit-out, --axis.
void add_cache_space(CLI::App& verb, CacheSpace& space);

}  // namespace bodyopt::cli
