// A frame as a mesh to be sculpted elsewhere, and back as a sculpt.
#pragma once

#include "cli/curate/curate_arguments.h"

namespace bodyopt::cli {

void export_frame(const CurateArguments& arguments);
void import_frame(const CurateArguments& arguments);

}  // namespace bodyopt::cli
