#include <gtest/gtest.h>

#include "tests/simulate/limb.h"
#include "trainer/tets/cage.h"

namespace bodyopt::trainer {
namespace {

constexpr double kOverlap = 1e-3, kAnyOverlap = 1;

// A limb whose upper side follows another joint.
Character two_sided_limb() {
  Character limb = make_limb();
  for (Eigen::Index v = 0; v < limb.vertices.rows(); ++v) {
    limb.weights[static_cast<std::size_t>(v)] = {{limb.vertices(v, 2) > 0 ? 1u : 0u, 1}};
  }
  return limb;
}

bool apart(const Character& skin, const Eigen::Vector3d& a, const Eigen::Vector3d& b, double overlap) {
  const NearestSkin nearest(skin.vertices, skin.triangles);
  return ApartSkin(skin.vertices, skin.triangles, skin.weights)(nearest(a), nearest(b), overlap);
}

// Half around a tube is at most 1.6 times the way through it.
TEST(ApartSkin, SidesOfALimbAreBesideEachOther) {
  EXPECT_FALSE(apart(two_sided_limb(), {0.25, 0, kTubeRadius}, {0.25, 0, -kTubeRadius}, kAnyOverlap));
  EXPECT_FALSE(apart(two_sided_limb(), {0.25, 0, -kTubeRadius}, {0.27, 0, kTubeRadius}, kAnyOverlap));
}

// Pressed flat the way around is fifty times as long as the way through; but that is flesh, however the triangles wind.
TEST(ApartSkin, FleshHoldsTheTwoSidesOfAThinPart) {
  Character limb = two_sided_limb();
  limb.vertices.col(2) *= 0.02;
  EXPECT_TRUE(apart(limb, {0.25, 0, 1}, {0.25, 0, -1}, kAnyOverlap));
  EXPECT_FALSE(apart(limb, {0.25, 0, 1}, {0.25, 0, -1}, kOverlap));
  limb.triangles.col(1).swap(limb.triangles.col(2));
  EXPECT_FALSE(apart(limb, {0.25, 0, 1}, {0.25, 0, -1}, kOverlap));
}

TEST(ApartSkin, SkinThatFacesSkinIsApartWhereOtherJointsMoveIt) {
  Character limbs = make_two_limbs(2.05 * kTubeRadius);
  const Eigen::RowVector3d middle = limbs.vertices.colwise().mean();
  const std::size_t half = limbs.weights.size() / 2;
  const Eigen::Vector3d one = limbs.vertices.row(0), between = middle;
  const Eigen::Vector3d aside = (one - between).cwiseProduct(Eigen::Vector3d(0, 1, 1)).normalized();
  const auto facing = [&] { return apart(limbs, between + 1e-3 * aside, between - 1e-3 * aside, kOverlap); };
  for (std::size_t v = 0; v < 2 * half; ++v) limbs.weights[v] = {{v < half ? 0u : 1u, 1}};
  EXPECT_TRUE(facing());
  limbs.triangles.col(1).swap(limbs.triangles.col(2));
  EXPECT_TRUE(facing());
  for (auto& weights : limbs.weights) weights = {{0, 1}};
  EXPECT_FALSE(facing());
}

// A strip a metre long, whose two edges follow two joints: no corner is near.
TEST(ApartSkin, OneTriangleIsBesideItself) {
  Character strip;
  strip.vertices.resize(4, 3);
  strip.vertices << 0, 0, 0, 1, 0, 0, 1, 0.1, 0, 0, 0.1, 0;
  strip.triangles.resize(2, 3);
  strip.triangles << 0, 1, 2, 0, 2, 3;
  strip.weights = {{{0, 1}}, {{0, 1}}, {{1, 1}}, {{1, 1}}};
  EXPECT_FALSE(apart(strip, {0.5, 0, 0}, {0.5, 0.1, 0}, kOverlap));
}

}  // namespace
}  // namespace bodyopt::trainer
