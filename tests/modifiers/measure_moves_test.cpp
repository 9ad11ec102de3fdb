
#include <gtest/gtest.h>

#include "tests/modifiers/driven_small_basis.h"
#include "trainer/modifiers/measure_modifiers.h"

namespace bodyopt::testing {
namespace measure_moves_test {

using namespace trainer;

std::vector<Pose> driven(const Basis& basis, float strength) {
  Basis weighted = basis;
  weighted.modifiers.stack[0].constants["strength"] = strength;
  std::vector<Pose> poses = bind_poses(basis, 40);
  drive_modifiers(weighted, {}, 24, poses);
  return poses;
}

// As far as the skin is from that of a clip which never had it: what it adds and what it turns.
TEST(MeasureMoves, IsTheDistanceToTheSkinWithoutIt) {
  const Basis basis = breathing_basis();
  const std::vector<Pose> poses = driven(basis, 1);
  EvaluatedSkin skin(basis);
  const std::vector<Positions> shown = skin(poses), bare = skin(driven(basis, 0));
  std::vector<double> largest;
  for (std::size_t k = 0; k < poses.size(); ++k) {
    largest.push_back((shown[k] - bare[k]).rowwise().norm().maxCoeff());
  }
  const std::vector<ModifierMove> moves = measure_moves(basis, poses);
  ASSERT_EQ(moves.size(), 1u);
  EXPECT_EQ(moves[0].modifier, "shown");
  EXPECT_GT(moves[0].largest, 1e-4);
  EXPECT_EQ(moves[0].largest, *std::ranges::max_element(largest));
  EXPECT_EQ(moves[0].largest, largest[moves[0].pose]);
}

TEST(MeasureMoves, LeavesOutWhatIsOff) {
  Basis basis = breathing_basis();
  const std::vector<Pose> poses = driven(basis, 0);
  ASSERT_EQ(measure_moves(basis, poses).size(), 1u);
  EXPECT_EQ(measure_moves(basis, poses)[0].largest, 0);
  basis.modifiers.stack[0].on = false;
  EXPECT_TRUE(measure_moves(basis, poses).empty());
}

}  // namespace measure_moves_test
}  // namespace bodyopt::testing
