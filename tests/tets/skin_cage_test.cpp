#include "trainer/tets/skin_cage.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <random>
#include <set>

#include "runtime/basis/error.h"
#include "tests/builtin/shared_arm.h"
#include "tests/simulate/limb.h"
#include "trainer/tets/closed_skin.h"
#include "trainer/tets/nearest_skin.h"
#include "trainer/tets/thickness.h"

namespace bodyopt {
namespace {

double volume(const TetMesh& mesh) {
  double sum = 0;
  for (Eigen::Index t = 0; t < mesh.tets.rows(); ++t) sum += tet_edges(mesh, t).determinant() / 6;
  return sum;
}

// A limb and the same once more beside it.
Character two_limbs(double apart) {
  const Character limb = make_limb();
  Character both = limb;
  const Eigen::Index count = limb.vertices.rows(), triangles = limb.triangles.rows();
  both.vertices.conservativeResize(2 * count, 3);
  both.vertices.bottomRows(count) = limb.vertices.rowwise() + Eigen::RowVector3d(0, apart, 0);
  both.triangles.conservativeResize(2 * triangles, 3);
  both.triangles.bottomRows(triangles) = (limb.triangles.array() + static_cast<std::uint32_t>(count)).matrix();
  return both;
}

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
    double sampled = 0;
    for (const CageSample& sample : cage.samples) sampled += sample.volume;
    EXPECT_NEAR(sampled / volume(cage.mesh), 1, 1e-9);
    EXPECT_LT((embed(cage.skin, cage.mesh.tets, cage.mesh.nodes) - character.vertices).cwiseAbs().maxCoeff(), 1e-12);
  }
}

TEST(SkinCage, WindingDoesNotMatter) {
  const Character limb = make_limb();
  const Cage cage = skin_cage(limb.vertices, limb.triangles, 300);
  const Triangles inside_out = limb.triangles.rowwise().reverse();
  EXPECT_NEAR(volume(skin_cage(limb.vertices, inside_out, 300).mesh) / volume(cage.mesh), 1, 0.02);
}

// 3 mm lie between the limbs, and much of either is outside its coarser skin.
TEST(SkinCage, PartsSideBySideAreCarriedByTheirOwn) {
  const Character both = two_limbs(2 * kLimbRadius + 0.003);
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

TEST(SkinCage, OpenSkinsAreRefused) {
  const Character limb = make_limb();
  const Triangles open = limb.triangles.topRows(limb.triangles.rows() - 1);
  EXPECT_THROW(skin_cage(limb.vertices, open, 300), Error);
}

TEST(MakeCage, TakesTheSkinWhereItCanBeFilled) {
  const Character& character = arm().character;
  EXPECT_FALSE(make_cage(character.vertices, character.triangles, 1500).is_lattice);
  const Triangles open = character.triangles.topRows(character.triangles.rows() - 1);
  const Cage lattice = make_cage(character.vertices, open, 1500);
  EXPECT_TRUE(lattice.is_lattice);
  EXPECT_NE(lattice.why_lattice.find("boundary edges"), std::string::npos) << lattice.why_lattice;
  // So coarse a skin leaves too much outside.
  const Cage coarse = make_cage(character.vertices, character.triangles, 120);
  EXPECT_TRUE(coarse.is_lattice);
  EXPECT_FALSE(coarse.why_lattice.empty());
}

TEST(Thickness, OfATubeIsItsDiameter) {
  const Character limb = make_limb();
  const Eigen::VectorXd thick = thickness(limb.vertices, limb.triangles);
  const Eigen::Index middle = kLimbSides * (kLimbRings / 2);
  for (Eigen::Index v = middle; v < middle + kLimbSides; ++v)
    EXPECT_NEAR(thick[v], 2 * kLimbRadius, 0.08 * kLimbRadius);
}

TEST(NearestSkin, IsTheNearestOfAllTriangles) {
  const Character& character = arm().character;
  const NearestSkin nearest(character.vertices, character.triangles);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-0.1, 0.9);
  for (int k = 0; k < 40; ++k) {
    const Eigen::Vector3d point(uniform(random), uniform(random), uniform(random));
    const SkinPoint found = nearest(point);
    const double distance = (found.position - point).norm();
    double sampled = 1e300;  // of points spread over every triangle: none may be nearer
    for (Eigen::Index t = 0; t < character.triangles.rows(); ++t) {
      for (int i = 0; i <= 4; ++i) {
        for (int j = 0; i + j <= 4; ++j) {
          const Eigen::RowVector3d p = (i * character.vertices.row(character.triangles(t, 0)) +
                                        j * character.vertices.row(character.triangles(t, 1)) +
                                        (4 - i - j) * character.vertices.row(character.triangles(t, 2))) /
                                       4;
          sampled = std::min(sampled, (p.transpose() - point).norm());
        }
      }
    }
    EXPECT_LE(distance, sampled + 1e-12);
    EXPECT_GT(distance, sampled - 0.01);
    const auto corners = character.triangles.row(found.triangle);
    Eigen::Vector3d at = Eigen::Vector3d::Zero();
    for (int a = 0; a < 3; ++a) at += found.weights[a] * character.vertices.row(corners[a]).transpose();
    EXPECT_LT((at - found.position).norm(), 1e-12);
    // The nearest that faces away from the point is another.
    const Eigen::Vector3d away = (found.position - point).normalized();
    const SkinPoint behind = nearest.facing(point, away);
    ASSERT_GE(behind.triangle, 0);
    EXPECT_GE((behind.position - point).norm(), distance);
    const auto other = character.triangles.row(behind.triangle);
    const Eigen::Vector3d a = character.vertices.row(other[0]), b = character.vertices.row(other[1]),
                          c = character.vertices.row(other[2]);
    EXPECT_GT((b - a).cross(c - a).dot(away), 0);
  }
}

}  // namespace
}  // namespace bodyopt
