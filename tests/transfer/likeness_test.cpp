// How alike limbs are that differ in one thing alone.
#include <gtest/gtest.h>

#include "geometry/mesh.h"
#include "geometry/surface_distance.h"
#include "tests/support/capsule_limb.h"
#include "trainer/train/skinning/ddm.h"
#include "trainer/transfer/transfer_pair.h"

namespace bodyopt::trainer {
namespace {

double likeness_of(const Character& source, const Character& target) {
  const Basis basis = build_ddm_basis(source, {});
  return likeness(TransferPair(basis, target, {}));
}

// A joint at the middle of the upper arm, which holds half of what the arm's joint held.
Character twisted_limb() {
  Character limb = limb_character();
  Joint twist = limb.skeleton.joints[1];
  twist.name = "twist";
  twist.parent = 1;
  twist.bind = twist.default_local = {};
  limb.skeleton.joints.push_back(twist);
  for (std::vector<JointWeight>& weights : limb.weights) {
    for (std::size_t k = 0, count = weights.size(); k < count; ++k) {
      if (weights[k].joint != 1) continue;
      weights[k].weight /= 2;
      weights.push_back({3, weights[k].weight});
    }
  }
  return limb;
}

}  // namespace

TEST(Likeness, OfABodyToItselfIsOne) { EXPECT_NEAR(likeness_of(limb_character(), limb_character()), 1, 1e-3); }

TEST(Likeness, AFinerRigIsNotAnotherBody) {
  EXPECT_NEAR(likeness_of(limb_character(), twisted_limb()), 1, 1e-3);
  EXPECT_NEAR(likeness_of(twisted_limb(), limb_character()), 1, 1e-3);
}

// The skin that the last joint holds, by area.
TEST(Likeness, SkinOfJointsThatNeitherSharesCountsAgainstIt) {
  Character other = limb_character();
  other.skeleton.joints[2].name = "unlike anything";
  const Eigen::VectorXd areas = lumped_areas(other.vertices, other.triangles);
  double lost = 0;
  for (Eigen::Index v = 0; v < areas.size(); ++v) {
    for (const JointWeight& weight : other.weights[static_cast<std::size_t>(v)]) {
      if (weight.joint == 2) lost += areas[v] * weight.weight / areas.sum();
    }
  }
  ASSERT_GT(lost, 0.1);
  EXPECT_NEAR(likeness_of(limb_character(), other), (1 - lost) * (1 - lost), 0.01);
}

// Bones of 0.3 and 0.2 m on the one, 0.2 and 0.3 m on the other: logarithms of +-log(1.5), weighed alike.
TEST(Likeness, OtherProportionsAreTheSpreadOfTheBones) {
  Skeleton other = limb_skeleton();
  const double heights[] = {0, 0.2, 0.5};
  for (std::size_t j = 1; j < 3; ++j) {
    Joint& joint = other.joints[j];
    joint.bind.translation[2] = heights[j] - heights[j - 1];
    joint.default_local = joint.bind;
    joint.inverse_bind.m[2][3] = -heights[j];
  }
  EXPECT_NEAR(match_skeletons(limb_skeleton(), other, "").other_proportions, std::log(1.5), 1e-9);
  EXPECT_NEAR(match_skeletons(limb_skeleton(), limb_skeleton(), "").other_proportions, 0, 1e-9);
}

// One half of the limb three times as thick, all else being what it is: lengths by the areas around the vertices.
TEST(Likeness, OtherProportionsOfTheSkinCountAgainstIt) {
  const Character limb = limb_character();
  Character other = limb;
  for (Eigen::Index v = 0; v < other.vertices.rows(); ++v) {
    if (other.vertices(v, 2) < 0.3) other.vertices.row(v).head<2>() *= 3;
  }
  const Basis source = build_ddm_basis(limb, {});
  const TransferPair pair(source, other, {});
  const Triangles triangles = rows_of(source.mesh.triangles);
  const Eigen::VectorXd thin = lumped_areas(rows_of(source.mesh.rest), triangles),
                        thick = lumped_areas(pair.correspondence.fitted, triangles);
  double alike = 0, mean = 0, square = 0;
  for (Eigen::Index v = 0; v < thin.size(); ++v) {
    const double share = thin[v] / thin.sum(), length = std::log(std::sqrt(thick[v] / thin[v]));
    alike += 0.5 * (share + thick[v] / thick.sum()) * pair.correspondence.source_alike[v];
    mean += share * length;
    square += share * length * length;
  }
  ASSERT_GT(square - mean * mean, 0.1);
  EXPECT_NEAR(likeness(pair), alike * std::exp(mean * mean - square), 1e-4);
}

}  // namespace bodyopt::trainer
