// Levels of detail while a character plays.
#include <gtest/gtest.h>

#include <array>

#include "viewport/scene/detail.h"

namespace bodyopt::testing {
namespace {

using namespace viewport;

struct Playing {
  std::size_t last = 0;
  int changes = 0;
};

// For so many seconds, with what a picture of each level takes.
template <std::size_t N>
Playing play(DetailChoice& choice, const std::array<double, N>& seconds, double duration) {
  Playing playing;
  for (double time = 0; time < duration; time += seconds[playing.last]) {
    const std::size_t level = choice.choose(seconds[playing.last], true, N);
    playing.changes += level != playing.last;
    playing.last = level;
  }
  return playing;
}

TEST(DetailChoice, TakesTheFinestThatKeepsUp) {
  DetailChoice quick, proxy, slow;
  EXPECT_EQ(play(quick, std::array{0.03, 0.01, 0.005}, 10).last, 0u);
  EXPECT_EQ(play(proxy, std::array{0.1, 0.03, 0.01}, 10).last, 1u);
  EXPECT_EQ(play(slow, std::array{0.5, 0.2, 0.1}, 10).last, 2u);
  EXPECT_EQ(slow.choose(0.1, false, 3), 0u) << "nothing plays";
}

// Levels are far apart: the one that is too slow may take ten times as long as the one that keeps up.
TEST(DetailChoice, DoesNotSwing) {
  DetailChoice choice;
  const std::array seconds = {0.08, 0.008, 0.004};
  EXPECT_EQ(play(choice, seconds, 7).changes, 1);
  // Tried again after 8, 16, 32 and 64 seconds: there and back.
  EXPECT_LE(play(choice, seconds, 150).changes, 9);
}

TEST(DetailChoice, ComesBackWhenThereIsTimeAgain) {
  DetailChoice choice;
  play(choice, std::array{0.08, 0.008}, 5);
  EXPECT_EQ(play(choice, std::array{0.02, 0.008}, 20).last, 0u);
}

}  // namespace
}  // namespace bodyopt::testing
