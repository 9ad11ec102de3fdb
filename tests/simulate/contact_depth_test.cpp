#include <gtest/gtest.h>

#include "tests/simulate/limb.h"
#include "trainer/simulate/contact.h"
#include "trainer/tets/cage.h"
#include "trainer/tets/lattice_cage.h"

namespace bodyopt::trainer {
namespace {

constexpr double kApart = 0.5;

// The second moved beside the first, its axis `between` from the other's.
Positions moved(const Cage& cage, double between) {
  Positions nodes = cage.mesh.nodes;
  for (Eigen::Index n = 0; n < nodes.rows(); ++n) {
    if (nodes(n, 1) > kApart / 2) nodes(n, 1) += between - kApart;
  }
  return nodes;
}

TEST(ContactDepth, IsThatOfOneTubeInAnother) {
  const Character both = make_two_limbs(kApart);
  for (const Cage& cage : {lattice_cage(both.vertices, both.triangles, both.weights, 800),
                           skin_cage(both.vertices, both.triangles, 800)}) {
    const SkinContact depth(both.vertices, both.triangles, cage);
    EXPECT_EQ(depth.deepest(cage.mesh.nodes), 0);
    EXPECT_EQ(depth.deepest(moved(cage, 2.1 * kTubeRadius)), 0);
    for (const double deep : {0.2 * kTubeRadius, 0.7 * kTubeRadius}) {
      // The tubes have ten sides: a corner reaches the radius, a side's middle 0.95 of it.
      EXPECT_NEAR(depth.deepest(moved(cage, 2 * kTubeRadius - deep)), deep, 0.1 * kTubeRadius) << cage.is_lattice;
    }
  }
}

// A fork whose prongs share cells of 15 cm, each with virtual nodes of its own. One slides along the other, through
// cells that reach over it but hold none of it.
TEST(ContactDepth, ALatticesEmptyCornersAreNoTissue) {
  Character fork = make_two_limbs(0.12);
  const Character bridge = make_limb();
  const Eigen::Index prongs = fork.vertices.rows(), more = bridge.vertices.rows(), triangles = fork.triangles.rows();
  fork.vertices.conservativeResize(prongs + more, 3);
  fork.vertices.bottomRows(more) << bridge.vertices.col(1), 0.4 * bridge.vertices.col(0), bridge.vertices.col(2);
  fork.triangles.conservativeResize(triangles + bridge.triangles.rows(), 3);
  fork.triangles.bottomRows(bridge.triangles.rows()) =
      (bridge.triangles.array() + static_cast<std::uint32_t>(prongs)).matrix();
  fork.weights.assign(static_cast<std::size_t>(prongs + more), {{0, 1}});
  const Cage cage = lattice_cage_of_size(fork.vertices, fork.triangles, fork.weights, 0.15);
  std::vector<bool> slides(static_cast<std::size_t>(cage.mesh.nodes.rows()), false);
  for (Eigen::Index v = prongs / 2; v < prongs; ++v) {
    if (fork.vertices(v, 0) < 0.26) continue;
    const int tet = cage.skin[static_cast<std::size_t>(v)].tet;
    for (int a = 0; a < 4; ++a) slides[static_cast<std::size_t>(cage.mesh.tets(tet, a))] = true;
  }
  Positions nodes = cage.mesh.nodes;
  for (Eigen::Index n = 0; n < nodes.rows(); ++n) {
    if (slides[static_cast<std::size_t>(n)]) nodes(n, 0) += 0.06;
  }
  EXPECT_EQ(SkinContact(fork.vertices, fork.triangles, cage).deepest(nodes), 0);
}

}  // namespace
}  // namespace bodyopt::trainer
