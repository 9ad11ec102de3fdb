#include "geometry/thickness.h"

#include <gtest/gtest.h>

#include "tests/simulate/limb.h"

namespace bodyopt {
namespace {

TEST(Thickness, OfATubeIsItsDiameter) {
  const Character limb = make_limb();
  const Eigen::VectorXd thick = thickness(limb.vertices, limb.triangles);
  const Eigen::Index middle = kTubeSides * (kTubeRings / 2);
  for (Eigen::Index v = middle; v < middle + kTubeSides; ++v)
    EXPECT_NEAR(thick[v], 2 * kTubeRadius, 0.08 * kTubeRadius);
}

TEST(Thickness, DoesNotDependOnTheWinding) {
  const Character limb = make_limb();
  const Triangles inside_out = limb.triangles.rowwise().reverse();
  EXPECT_LT((thickness(limb.vertices, inside_out) - thickness(limb.vertices, limb.triangles)).cwiseAbs().maxCoeff(),
            1e-9);
}

// As thin as anything is taken to be: no NaN, nor does it spread.
TEST(Thickness, OfALooseVertexIsTheLeast) {
  Character limb = make_limb();
  const Eigen::Index count = limb.vertices.rows();
  limb.vertices.conservativeResize(count + 1, 3);
  limb.vertices.row(count) << 0.25, 0, 0;
  const Eigen::VectorXd thick = thickness(limb.vertices, limb.triangles);
  EXPECT_NEAR(thick[count], kTubeLength / 180, 1e-9);
  EXPECT_EQ(thick.head(count), thickness(limb.vertices.topRows(count), limb.triangles));
}

}  // namespace
}  // namespace bodyopt
