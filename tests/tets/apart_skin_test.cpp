#include "trainer/tets/apart_skin.h"

#include <gtest/gtest.h>

#include "tests/simulate/limb.h"

namespace bodyopt {
namespace {

// A limb whose lower side follows joint 0 and whose upper side follows another.
class TwoSides : public ::testing::Test {
 protected:
  void follow(std::uint32_t above) {
    for (Eigen::Index v = 0; v < limb_.vertices.rows(); ++v) {
      limb_.weights[static_cast<std::size_t>(v)] = {{limb_.vertices(v, 2) > 0 ? above : 0u, 1}};
    }
  }
  SkinPoint above(double x) const { return nearest_({x, 0, kTubeRadius}); }
  SkinPoint below(double x) const { return nearest_({x, 0, -kTubeRadius}); }
  bool apart(const SkinPoint& a, const SkinPoint& b) const {
    return ApartSkin(limb_.vertices, limb_.triangles, limb_.weights, kOverlap)(a, b);
  }

  static constexpr double kOverlap = 1e-3;
  Character limb_ = make_limb();
  NearestSkin nearest_{limb_.vertices, limb_.triangles};
};

// Half around a tube is at most 1.6 times the way through it.
TEST_F(TwoSides, OfOneLimbAreBesideEachOther) {
  follow(1);
  EXPECT_FALSE(apart(above(0.25), below(0.25)));
  EXPECT_FALSE(apart(below(0.25), above(0.27)));
}

// Pressed flat they nearly touch, and the way around stays as long: inside out, with air between them, they are skin on
// skin.
TEST_F(TwoSides, ThatNearlyTouchAreApartWhereOtherJointsMoveThem) {
  limb_.vertices.col(2) *= 0.02;
  const NearestSkin flat(limb_.vertices, limb_.triangles);
  const SkinPoint a = flat({0.25, 0, 1}), b = flat({0.25, 0, -1});
  follow(1);
  EXPECT_FALSE(apart(a, b));  // 1.6 mm of flesh
  limb_.triangles.col(1).swap(limb_.triangles.col(2));
  const NearestSkin turned(limb_.vertices, limb_.triangles);
  const SkinPoint c = turned({0.25, 0, 1}), d = turned({0.25, 0, -1});
  EXPECT_TRUE(apart(c, d));
  EXPECT_TRUE(apart(d, c));
  EXPECT_FALSE(apart(c, c));
  follow(0);
  EXPECT_FALSE(apart(c, d));
}

}  // namespace
}  // namespace bodyopt
