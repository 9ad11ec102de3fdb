// What `proxy` and `info` tell of levels of detail.
#pragma once

#include <string>
#include <vector>

#include "cli/arguments/common.h"
#include "runtime/basis/levels.h"
#include "trainer/proxy/build_proxy.h"

namespace bodyopt::cli {

// A list with an entry per level: what was measured of it when it was made, and its time of a frame, measured now.
Json levels_info(const std::vector<Level>& levels, const ProxyReport& report);
// The same as text.
std::string level_table(const Json& levels);

}  // namespace bodyopt::cli
