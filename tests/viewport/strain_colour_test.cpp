#include "viewport/state/strain_colour.h"

#include <gtest/gtest.h>

namespace bodyopt::testing {
namespace {

using namespace viewport;

TEST(StrainColour, IsBlueWhereShorterAndRedWhereLonger) {
  const auto channel = [](float strain, int k) { return static_cast<int>(strain_colour(strain) >> (8 * k) & 255); };
  EXPECT_GT(channel(-0.33f, 2), channel(-0.33f, 0) + 100);
  EXPECT_GT(channel(0.33f, 0), channel(0.33f, 2) + 100);
  EXPECT_EQ(strain_colour(0.34f), strain_colour(5));  // full at a third
  EXPECT_EQ(strain_colour(-0.34f), strain_colour(-5));
  EXPECT_NE(strain_colour(0.1f), strain_colour(0.2f));
  for (const float strain : {-1.0f, 0.0f, 1.0f}) EXPECT_EQ(channel(strain, 3), 255);
}

}  // namespace
}  // namespace bodyopt::testing
