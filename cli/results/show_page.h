// What a show on a farm has come to, as a page for people.
#pragma once

#include <string>

#include "cli/arguments/common.h"
#include "farm/show_summary.h"

namespace bodyopt::cli {

// Self-contained HTML. The frames worth a look are drawn from the caches, on a Vulkan device; where there is none, or a
// cache is gone, the page says so.
std::string show_page(const FarmPlan& plan, const ShowSummary& summary);

// The same for programs, without pictures.
Json to_json(const FarmPlan& plan, const ShowSummary& summary);

// The options of `simulate` that name these frames, quoted for a shell.
std::string simulate_options(const FramesToSimulate& next);

}  // namespace bodyopt::cli
