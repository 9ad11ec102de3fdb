#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <set>

#include "geometry/mend_surface.h"
#include "geometry/thickness.h"
#include "runtime/core/error.h"
#include "tests/builtin/shared_arm.h"
#include "tests/simulate/limb.h"
#include "trainer/tets/cage.h"

namespace bodyopt::trainer {
namespace {

TEST(SkinCage, FillsWhatTheSkinEncloses) {
  const Character& character = arm().character;
  const double enclosed = enclosed_volume(character.vertices, character.triangles);
  for (const Eigen::Index nodes : {600, 1500}) {
    const Cage cage = skin_cage(character.vertices, character.triangles, nodes);
    EXPECT_FALSE(cage.is_lattice);
    EXPECT_LE(cage.mesh.nodes.rows(), nodes);
    EXPECT_GT(cage.mesh.nodes.rows(), 0.85 * static_cast<double>(nodes));
    EXPECT_GT(cage.mesh.worst_quality, 0.05);
    EXPECT_NEAR(volume(cage.mesh) / enclosed, 1, 0.02);
    EXPECT_LT((embed(cage.skin, cage.mesh.tets, cage.mesh.nodes) - character.vertices).cwiseAbs().maxCoeff(), 1e-12);
    const auto far = std::count_if(cage.skin.begin(), cage.skin.end(),
                                   [](const EmbeddedPoint& point) { return point.weights.minCoeff() < -0.5; });
    EXPECT_LT(static_cast<double>(far), 0.01 * static_cast<double>(cage.skin.size())) << nodes;
  }
}

TEST(SkinCage, WindingDoesNotMatter) {
  const Character limb = make_limb();
  const Cage cage = skin_cage(limb.vertices, limb.triangles, 300);
  const Triangles inside_out = limb.triangles.rowwise().reverse();
  EXPECT_NEAR(volume(skin_cage(limb.vertices, inside_out, 300).mesh) / volume(cage.mesh), 1, 0.02);
}

// 12 mm lie between the limbs, and much of either is outside its coarser skin.
TEST(SkinCage, PartsSideBySideAreCarriedByTheirOwn) {
  const Character both = make_two_limbs(2 * kTubeRadius + 0.012);
  const Cage cage = skin_cage(both.vertices, both.triangles, 400);
  const std::size_t half = cage.skin.size() / 2;
  std::set<int> nodes;
  for (std::size_t v = 0; v < half; ++v) {
    for (int a = 0; a < 4; ++a) nodes.insert(cage.mesh.tets(cage.skin[v].tet, a));
  }
  for (std::size_t v = half; v < cage.skin.size(); ++v) {
    for (int a = 0; a < 4; ++a) ASSERT_FALSE(nodes.contains(cage.mesh.tets(cage.skin[v].tet, a))) << v;
  }
}

TEST(SkinCage, ThinPartsHaveShorterEdges) {
  const Character& character = arm().character;
  const Cage cage = skin_cage(character.vertices, character.triangles, 1500);
  const Eigen::VectorXd thick = thickness(character.vertices, character.triangles);
  const double thin = thick.minCoeff() * 1.5, wide = thick.maxCoeff() / 1.5;
  double sum[2] = {0, 0}, count[2] = {0, 0};  // of the volume's edge where the body is thin, and where it is wide
  for (Eigen::Index v = 0; v < thick.size(); ++v) {
    if (thick[v] > thin && thick[v] < wide) continue;
    const int k = thick[v] > thin ? 1 : 0;
    sum[k] += std::cbrt(tet_edges(cage.mesh, cage.skin[static_cast<std::size_t>(v)].tet).determinant());
    ++count[k];
  }
  ASSERT_GT(count[0], 10);
  ASSERT_GT(count[1], 10);
  EXPECT_LT(1.4 * sum[0] / count[0], sum[1] / count[1]);
}

TEST(SkinCage, IsTheSameEveryTime) {
  const Character limb = make_limb();
  const Cage a = skin_cage(limb.vertices, limb.triangles, 300), b = skin_cage(limb.vertices, limb.triangles, 300);
  EXPECT_EQ(a.mesh.nodes, b.mesh.nodes);
  EXPECT_EQ(a.mesh.tets, b.mesh.tets);
}

TEST(SkinCage, SkinsWithoutAreaAreRefused) {
  Character limb = make_limb();
  limb.vertices.col(1).setZero();
  EXPECT_THROW(skin_cage(limb.vertices, limb.triangles, 300), Error);  // flat: it encloses nothing
  limb.vertices.col(2).setZero();
  EXPECT_THROW(skin_cage(limb.vertices, limb.triangles, 300), Error);  // a line
}

// A coarser skin that is moved through itself is refused by place.
TEST(SkinCage, SkinsThatPassThroughThemselvesAreRefused) {
  const Character limb = make_limb();
  const FineSkin fine(limb.vertices, limb.triangles);
  const auto spike = [](CoarseSkin& skin) {
    const Eigen::RowVector3d middle = skin.vertices.colwise().mean();
    Eigen::Index nearest = 0;
    (skin.vertices.rowwise() - middle).rowwise().squaredNorm().minCoeff(&nearest);
    skin.vertices.row(nearest) += 2.3 * (middle - skin.vertices.row(nearest));
  };
  try {
    fill_coarser(fine, {.nodes = 300}, spike);
    FAIL() << "filled";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::mismatch);
    EXPECT_NE(std::string(error.what()).find("passes through itself at"), std::string::npos) << error.what();
  }
}

TEST(SkinCage, OpenSkinsAreRefused) {
  const Character limb = make_limb();
  const Triangles open = limb.triangles.topRows(limb.triangles.rows() - 1);
  EXPECT_THROW(skin_cage(limb.vertices, open, 300), Error);
}

}  // namespace
}  // namespace bodyopt::trainer
