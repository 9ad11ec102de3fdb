#include <gtest/gtest.h>

#include <cmath>

#include "viewport/compare/error_measuring.h"

namespace bodyopt::testing {
namespace {

using namespace viewport;

TEST(HeatScale, IsTheNextOfOneTwoFive) {
  for (const auto& [mm, expected] : {std::pair(0.9, 1.0),
                                     {1.0, 1.0},
                                     {1.1, 2.0},
                                     {2.1, 5.0},
                                     {5.01, 10.0},
                                     {70.0, 100.0},
                                     {0.13, 0.2},
                                     {0.0, 0.1},
                                     {1e9, 1000.0}}) {
    EXPECT_NEAR(round_heat(mm), expected, 1e-9 * expected) << mm;
  }
  EXPECT_NEAR(round_heat(5.0005), 5, 1e-9);
}

TEST(HeatScale, OnlyRisesWhileItPlaysAndStaysWhereNothingIsKnown) {
  HeatScale scale;
  EXPECT_EQ(scale.choose({}, false), 10);
  EXPECT_EQ(scale.choose(1.5, true), 2) << "the first that is known";
  EXPECT_EQ(scale.choose(0.3, true), 2);
  EXPECT_EQ(scale.choose(3.0, true), 5);
  EXPECT_EQ(scale.choose(30.0, false), 50);
  EXPECT_EQ(scale.choose({}, false), 50);
}

}  // namespace
}  // namespace bodyopt::testing
