#include "trainer/simulate/carried_depth.h"

#include <gtest/gtest.h>

#include "tests/simulate/limb.h"
#include "trainer/tets/lattice_cage.h"
#include "trainer/tets/skin_cage.h"

namespace bodyopt {
namespace {

constexpr double kApart = 0.5;

// Two limbs side by side, half a metre apart.
Character two_limbs() {
  const Character limb = make_limb();
  Character both = limb;
  const Eigen::Index count = limb.vertices.rows(), triangles = limb.triangles.rows();
  both.vertices.conservativeResize(2 * count, 3);
  both.vertices.bottomRows(count) = limb.vertices.rowwise() + Eigen::RowVector3d(0, kApart, 0);
  both.triangles.conservativeResize(2 * triangles, 3);
  both.triangles.bottomRows(triangles) = (limb.triangles.array() + static_cast<std::uint32_t>(count)).matrix();
  return both;
}

// The second moved beside the first, its axis `between` from the other's.
Positions moved(const Cage& cage, double between) {
  Positions nodes = cage.mesh.nodes;
  for (Eigen::Index n = 0; n < nodes.rows(); ++n) {
    if (nodes(n, 1) > kApart / 2) nodes(n, 1) += between - kApart;
  }
  return nodes;
}

TEST(CarriedDepth, IsThatOfOneTubeInAnother) {
  const Character both = two_limbs();
  for (const Cage& cage :
       {lattice_cage(both.vertices, both.triangles, 800), skin_cage(both.vertices, both.triangles, 800)}) {
    const CarriedDepth depth(both, cage);
    EXPECT_EQ(depth.deepest(cage.mesh.nodes), 0);
    EXPECT_EQ(depth.deepest(moved(cage, 2.1 * kLimbRadius)), 0);
    for (const double deep : {0.2 * kLimbRadius, 0.7 * kLimbRadius}) {
      // The tubes have ten sides: a corner reaches the radius, a side's middle 0.95 of it.
      EXPECT_NEAR(depth.deepest(moved(cage, 2 * kLimbRadius - deep)), deep, 0.1 * kLimbRadius) << cage.is_lattice;
    }
  }
}

}  // namespace
}  // namespace bodyopt
