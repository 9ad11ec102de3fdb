#include "bench/refine_tets.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "geometry/closed_skin.h"
#include "tests/simulate/limb.h"
#include "trainer/dynamics/dynamics_tets.h"

namespace bodyopt::bench {
namespace {

TEST(RefineTets, EveryTetIsCutIntoEightOfItsVolume) {
  const Character limb = make_limb();
  const DynamicsTets coarse = make_dynamics_tets(limb.vertices, limb.triangles, limb.weights, 25000);
  const TetMesh& mesh = coarse.cage.mesh;
  const FilledSkin fine = refine_tets(mesh, static_cast<Eigen::Index>(coarse.surface.size()));
  ASSERT_EQ(fine.mesh.tets.rows(), 8 * mesh.tets.rows());
  for (Eigen::Index t = 0; t < fine.mesh.tets.rows(); ++t) {
    const double whole = tet_edges(mesh, t / 8).determinant();
    ASSERT_NEAR(tet_edges(fine.mesh, t).determinant(), whole / 8, 1e-9 * whole);
  }
  require_closed(fine.skin.vertices, fine.skin.triangles);  // throws
  EXPECT_EQ(fine.skin.triangles.rows(), 4 * limb.triangles.rows());
  EXPECT_NEAR(enclosed_volume(fine.skin.vertices, fine.skin.triangles),
              std::abs(enclosed_volume(limb.vertices, limb.triangles)), 1e-7);
  EXPECT_EQ(fine.skin.vertices, fine.mesh.nodes.topRows(fine.skin.vertices.rows()));
}

}  // namespace
}  // namespace bodyopt::bench
