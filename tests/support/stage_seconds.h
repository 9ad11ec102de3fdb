// The seconds that the stages of frames took.
#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "runtime/host/stages.h"

namespace bodyopt::testing {

// Of these stages and no others, in their order.
inline void expect_times(const StageSeconds& times, const std::vector<Stage>& expected) {
  std::vector<Stage> stages;
  times.for_each([&](const StageDescription& description, double seconds) {
    stages.push_back(description.stage);
    EXPECT_GT(seconds, 0) << description.name;
  });
  EXPECT_EQ(stages, expected);
}

}  // namespace bodyopt::testing
