#include "tests/support/stage_seconds.h"

#include <gtest/gtest.h>

namespace bodyopt::testing {

void expect_times(const StageSeconds& times, const std::vector<Stage>& expected) {
  std::vector<Stage> stages;
  times.for_each([&](const StageDescription& description, double seconds) {
    stages.push_back(description.stage);
    EXPECT_GT(seconds, 0) << description.name;
  });
  EXPECT_EQ(stages, expected);
}

}  // namespace bodyopt::testing
