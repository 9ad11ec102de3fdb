// The seconds that the stages of frames took.
#pragma once

#include <vector>

#include "runtime/host/stages.h"

namespace bodyopt::testing {

// Of these stages and no others, in their order.
void expect_times(const StageSeconds& times, const std::vector<Stage>& expected);

}  // namespace bodyopt::testing
