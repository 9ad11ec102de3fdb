#include "bench/split_bones.h"

#include <gtest/gtest.h>

#include "tests/support/capsule_limb.h"
#include "tests/support/random_tables.h"
#include "trainer/train/skinning/linear_blend.h"

namespace bodyopt::bench {
namespace {

Positions blended_skin(const Character& character, const Pose& pose) {
  const std::vector<BlendMatrix> matrices = blend_matrices(character.skeleton, pose);
  Positions skin(character.vertices.rows(), 3);
  for (Eigen::Index v = 0; v < skin.rows(); ++v) {
    const BlendMatrix m = blended(matrices, character.weights[static_cast<std::size_t>(v)]);
    skin.row(v) = m.leftCols<3>() * character.vertices.row(v).transpose() + m.col(3);
  }
  return skin;
}

// The middles at rest, whatever the others do.
TEST(SplitBones, MoveAsBefore) {
  const Character coarse = limb_character(), fine = split_bones(coarse);
  ASSERT_GT(fine.skeleton.size(), coarse.skeleton.size());
  testing::Random random(3);
  Pose before = bind_pose(coarse.skeleton), after = bind_pose(fine.skeleton);
  for (std::size_t j = 0; j < coarse.skeleton.size(); ++j) {
    before.joints[j].rotation = after.joints[j].rotation = before.joints[j].rotation * random.turn(1);
  }
  EXPECT_LT((blended_skin(coarse, before) - blended_skin(fine, after)).cwiseAbs().maxCoeff(), 1e-9);
}

}  // namespace
}  // namespace bodyopt::bench
