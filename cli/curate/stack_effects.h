// What the modifiers of the stack do to the shapes.
#pragma once

#include "cli/curate/curate_arguments.h"

namespace bodyopt::cli {

void report_effects(const CurateArguments& arguments);

}  // namespace bodyopt::cli
