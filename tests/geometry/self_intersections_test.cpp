#include "geometry/self_intersections.h"

#include <gtest/gtest.h>

#include <set>

#include "geometry/mend_surface.h"
#include "tests/simulate/limb.h"

namespace bodyopt {
namespace {

// Two triangles, the second of which stands upright in the plane x = 0.
Positions standing(double height) {
  Positions vertices(6, 3);
  vertices << -1, -1, 0, 1, -1, 0, 0, 2, 0, 0, 0, height - 1, 0, 0.5, height - 1, 0, 0.2, height + 1;
  return vertices;
}

TEST(SelfIntersections, AreFoundWhereAnEdgePassesThrough) {
  Triangles two(2, 3);
  two << 0, 1, 2, 3, 4, 5;
  EXPECT_EQ(self_intersections(standing(0), two), (std::vector<TrianglePair>{{0, 1}}));
  EXPECT_TRUE(self_intersections(standing(1.5), two).empty());
  EXPECT_TRUE(self_intersections(standing(-1.5), two).empty());
}

TEST(SelfIntersections, NeighboursAndPlanesHaveNone) {
  Positions plane(9, 3);
  for (int i = 0; i < 9; ++i) plane.row(i) << 0.1 * (i % 3) + 0.3 * (i / 3), 0.7 * (i / 3), 0.2 * (i % 3);
  Triangles fan(8, 3);
  fan << 0, 1, 4, 0, 4, 3, 1, 2, 5, 1, 5, 4, 3, 4, 7, 3, 7, 6, 4, 5, 8, 4, 8, 7;
  EXPECT_TRUE(self_intersections(plane, fan).empty());
  const Character limb = make_limb();
  EXPECT_TRUE(self_intersections(limb.vertices, limb.triangles).empty());
}

// A vertex pulled through the limb to its far side: found where it is, and moved back out of it.
TEST(Untangle, MovesApartAndLeavesTheRest) {
  const Character limb = make_limb();
  Positions spiked = limb.vertices;
  const Eigen::RowVector3d middle = limb.vertices.colwise().mean();
  Eigen::Index spike = 0;
  (limb.vertices.rowwise() - middle).rowwise().squaredNorm().minCoeff(&spike);
  spiked.row(spike) = 2.3 * middle - 1.3 * spiked.row(spike);
  const std::vector<TrianglePair> pairs = self_intersections(spiked, limb.triangles);
  ASSERT_FALSE(pairs.empty());
  bool at_spike = false;
  for (const TrianglePair& pair : pairs) {
    for (const Eigen::Index t : {pair.first, pair.second}) {
      at_spike = at_spike || (limb.triangles.row(t).array() == static_cast<std::uint32_t>(spike)).any();
    }
  }
  EXPECT_TRUE(at_spike);
  Positions mended = spiked;
  ASSERT_TRUE(untangle(limb.triangles, 1, mended));
  EXPECT_TRUE(self_intersections(mended, limb.triangles).empty());
  const Eigen::VectorXd moved = (mended - spiked).rowwise().norm();
  EXPECT_LT((moved.array() > 0).count(), limb.vertices.rows() / 2);
}

// Two limbs side by side, one sent through the side of the other.
TEST(Untangle, StepsStopBeforeASurfacePassesThroughItself) {
  const double gap = 0.012;
  const Character both = make_two_limbs(2 * kTubeRadius + gap);
  const Eigen::Index half = both.vertices.rows() / 2;
  const Eigen::RowVector3d across =
      both.vertices.topRows(half).colwise().mean() - both.vertices.bottomRows(half).colwise().mean();
  Positions steps = Positions::Zero(both.vertices.rows(), 3);
  steps.bottomRows(half).rowwise() += across.normalized() * 2 * gap;
  ASSERT_FALSE(self_intersections(both.vertices + steps, both.triangles).empty());
  Positions moved = both.vertices;
  step_apart(both.triangles, steps, moved);
  EXPECT_TRUE(self_intersections(moved, both.triangles).empty());
  EXPECT_EQ(moved.topRows(half), both.vertices.topRows(half));
  const Eigen::VectorXd far = (moved - both.vertices).bottomRows(half).rowwise().norm();
  EXPECT_NEAR(far.maxCoeff(), 2 * gap, 1e-12);  // what meets nothing takes the whole step
  EXPECT_GT((far.array() > 0).count(), half / 2);
  Positions freely = both.vertices;
  step_apart(both.triangles, steps / 5, freely);
  EXPECT_EQ(freely, both.vertices + steps / 5);
}

}  // namespace
}  // namespace bodyopt
