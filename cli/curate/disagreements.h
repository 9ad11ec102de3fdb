// Frames of like poses whose shapes disagree.
#pragma once

#include "cli/curate/curate_arguments.h"

namespace bodyopt::cli {

void report_disagreements(const CurateArguments& arguments);

}  // namespace bodyopt::cli
