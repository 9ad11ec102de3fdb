// Modifiers put on the stack, and changed.
#pragma once

#include "cli/curate/curate_arguments.h"

namespace bodyopt::cli {

void add_to_stack(const CurateArguments& arguments);
// `strength_given`: what is not named stays.
void edit_stack(const CurateArguments& arguments, bool strength_given);

}  // namespace bodyopt::cli
