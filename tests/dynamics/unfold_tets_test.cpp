#include <gtest/gtest.h>

#include <Eigen/LU>

#include "geometry/mesh.h"
#include "runtime/deformer/deformer.h"
#include "runtime/host/device_choice.h"
#include "tests/support/capsule_limb.h"
#include "tests/support/limb_dynamics.h"
#include "trainer/dynamics/dynamics_tets.h"
#include "trainer/dynamics/jiggle_fields.h"

namespace bodyopt::trainer {
namespace {

// The limb's skin with its elbow bent so far, by its basis; in the character's order, which output vertices have.
std::vector<Positions> bent_skins() {
  Deformer deformer(limb_model().basis, {.name = "cpu"});
  std::vector<Positions> skins;
  for (const double elbow : {-2.6, 1.0, 2.2, 2.8}) {
    const Pose pose = limb_pose({{}, 0.3, elbow});
    skins.push_back(rows_of(deformer.evaluate({&pose, 1}).positions));
  }
  return skins;
}

Eigen::Index inverted(const DynamicsTets& tets, const std::vector<Positions>& skins) {
  Eigen::Index count = 0;
  for (const Positions& skin : skins) {
    Eigen::MatrixXd on_skin = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(tets.surface.size()), 3);
    for (std::size_t n = 0; n < tets.surface.size(); ++n) {
      for (std::size_t k = 0; k < 3; ++k) {
        on_skin.row(static_cast<Eigen::Index>(n)) +=
            tets.surface[n].weights[static_cast<Eigen::Index>(k)] * skin.row(tets.surface[n].vertices[k]);
      }
    }
    TetMesh posed = tets.cage.mesh;
    posed.nodes = diffuse(tets.cage.mesh, on_skin);
    for (Eigen::Index t = 0; t < posed.tets.rows(); ++t) count += tet_edges(posed, t).determinant() <= 0 ? 1 : 0;
  }
  return count;
}

TEST(UnfoldTets, FewerAreInsideOutInThePoses) {
  const Character limb = limb_character();
  const std::vector<Positions> skins = bent_skins();
  const DynamicsTets before = make_dynamics_tets(limb.vertices, limb.triangles, limb.weights, 1500),
                     after = make_dynamics_tets(limb.vertices, limb.triangles, limb.weights, 1500, skins);
  EXPECT_EQ(before.unfolding.poses, 0);
  EXPECT_EQ(after.unfolding.poses, 4);
  EXPECT_EQ(after.unfolding.before, inverted(before, skins));
  EXPECT_EQ(after.unfolding.after, inverted(after, skins));
  EXPECT_GT(after.unfolding.before, 5);
  EXPECT_LT(4 * after.unfolding.after, after.unfolding.before);
  // The same tets of sound shape, their surface on the skin.
  EXPECT_EQ(after.cage.mesh.tets, before.cage.mesh.tets);
  EXPECT_GE(tet_quality(after.cage.mesh).worst, std::min(0.12, tet_quality(before.cage.mesh).worst - 1e-6));
  for (std::size_t n = 0; n < after.surface.size(); ++n) {
    const Eigen::Vector3d node = after.cage.mesh.nodes.row(static_cast<Eigen::Index>(n));
    EXPECT_LT((after.surface[n].position - node).norm(), 1e-7);
  }
}

// A skin that is taken as it is stays where it is.
TEST(UnfoldTets, MovesNoVertexOfTheSkinItself) {
  const Character limb = limb_character();
  const DynamicsTets tets = make_dynamics_tets(limb.vertices, limb.triangles, limb.weights, 25000, bent_skins());
  EXPECT_GT(tets.unfolding.before, 0);
  EXPECT_LE(tets.unfolding.after, tets.unfolding.before);
  for (Eigen::Index v = 0; v < limb.vertices.rows(); ++v) {
    EXPECT_LT((tets.cage.mesh.nodes.row(v) - limb.vertices.row(v)).norm(), 1e-7);
  }
}

}  // namespace
}  // namespace bodyopt::trainer
