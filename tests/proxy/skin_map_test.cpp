#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "geometry/mesh.h"
#include "runtime/host/carry_skin.h"
#include "tests/support/capsule_limb.h"
#include "trainer/proxy/build_proxy.h"
#include "trainer/proxy/level_skins.h"
#include "trainer/train/skinning/ddm.h"

namespace bodyopt::trainer {
namespace {

// The limb with a seam: the last three output vertices are the first three once more.
Character seamed_limb() {
  Character limb = limb_character();
  for (const std::uint32_t v : {0u, 1u, 2u}) limb.output_vertex.push_back(v);
  return limb;
}

MeshTable coarse_mesh(const Character& limb) {
  const Character proxy = proxy_character(limb, simplify_skin(limb, {limb.vertices}, 2e-3));
  return make_mesh_table(in_order(proxy, morton_order(proxy.vertices)));
}

// Rest vertices of the mesh, turned and moved.
std::vector<float> moved(const std::vector<float>& rest, const Eigen::Isometry3d& motion) {
  std::vector<float> result;
  for (std::size_t k = 0; k < rest.size(); k += 3) {
    const Eigen::Vector3d x = motion * Eigen::Vector3f(rest.data() + k).cast<double>();
    for (int i = 0; i < 3; ++i) result.push_back(static_cast<float>(x[i]));
  }
  return result;
}

TEST(MapSkin, IsExactAtRestAndUnderRigidMotion) {
  const Character limb = seamed_limb();
  const MeshTable mesh = coarse_mesh(limb);
  ASSERT_LT(mesh.vertex_count(), 300u);
  const CarriedSkin carried = map_skin(limb, mesh);
  ASSERT_EQ(carried.size(), limb.output_vertex.size());
  Eigen::Isometry3d turned = Eigen::Isometry3d::Identity();
  turned.rotate(Eigen::AngleAxisd(2.1, Eigen::Vector3d(1, -2, 0.5).normalized()));
  turned.pretranslate(Eigen::Vector3d(0.4, -1, 2));
  for (const Eigen::Isometry3d& motion : {Eigen::Isometry3d::Identity(), turned}) {
    const ShownSkin skin = show_skin(mesh, moved(mesh.rest, motion));
    const std::vector<float> full = carry_skin(mesh, carried, skin.positions, skin.normals);
    for (std::size_t o = 0; o < carried.size(); ++o) {
      const Eigen::Vector3d expected = motion * limb.vertices.row(limb.output_vertex[o]).transpose();
      EXPECT_LT((Eigen::Vector3f(full.data() + 3 * o).cast<double>() - expected).norm(), 2e-6) << o;
    }
  }
}

// The weights are rounded, the offsets begin where they are; the largest offset takes all steps.
TEST(MapSkin, OffsetsAreOfTheFinestSteps) {
  const Character limb = seamed_limb();
  const CarriedSkin carried = map_skin(limb, coarse_mesh(limb));
  int largest = 0;
  for (const CarriedPoint& point : carried.points) {
    for (const int steps : {point.along_normal, point.along_edge, point.across}) {
      largest = std::max(largest, std::abs(steps));
    }
  }
  EXPECT_EQ(largest, 32767);
  EXPECT_LT(carried.step, 1e-6f);
  const auto copies = carried.size() - 3;
  EXPECT_EQ(carried.points[copies].triangle, carried.points[0].triangle);
  EXPECT_EQ(carried.points[copies].along_normal, carried.points[0].along_normal);
}

TEST(MapSkin, FramesAreCarriedOneByOne) {
  const Character limb = seamed_limb();
  const MeshTable mesh = coarse_mesh(limb);
  const CarriedSkin carried = map_skin(limb, mesh);
  Eigen::Isometry3d up = Eigen::Isometry3d::Identity();
  up.pretranslate(Eigen::Vector3d(0, 3, 0));
  ShownSkin two = show_skin(mesh, mesh.rest);
  const ShownSkin second = show_skin(mesh, moved(mesh.rest, up));
  two.positions.insert(two.positions.end(), second.positions.begin(), second.positions.end());
  two.normals.insert(two.normals.end(), second.normals.begin(), second.normals.end());
  const std::vector<float> full = carry_skin(mesh, carried, two.positions, two.normals);
  ASSERT_EQ(full.size(), 6 * carried.size());
  for (std::size_t k = 0; k < 3 * carried.size(); ++k) {
    EXPECT_NEAR(full[3 * carried.size() + k] - full[k], k % 3 == 1 ? 3 : 0, 2e-6);
  }
}

// Two fingers a millimetre apart, or a limb pressed flat: the nearest triangle may be on the other side.
TEST(MapSkin, EveryVertexIsCarriedByItsOwnSide) {
  Character flat = limb_character();
  flat.vertices.col(1) *= 0.02;
  const Character proxy = proxy_character(flat, simplify_skin(flat, {limb_character().vertices}, 2e-3));
  const MeshTable mesh = make_mesh_table(in_order(proxy, morton_order(proxy.vertices)));
  const Positions normals = vertex_normals(flat.vertices, flat.triangles);
  const CarriedSkin carried = map_skin(flat, mesh);
  for (std::size_t v = 0; v < carried.size(); ++v) {
    const auto corner = [&](Eigen::Index k) -> Eigen::Vector3d {
      return proxy.vertices.row(proxy.triangles(carried.points[v].triangle, k));
    };
    const Eigen::Vector3d facing = (corner(1) - corner(0)).cross(corner(2) - corner(0));
    EXPECT_GT(facing.dot(normals.row(static_cast<Eigen::Index>(v))), 0) << v;
  }
}

TEST(CarrySkin, TrianglesWithoutExtentGiveFiniteNumbers) {
  const Character limb = seamed_limb();
  const MeshTable mesh = coarse_mesh(limb);
  const CarriedSkin carried = map_skin(limb, mesh);
  const std::vector<float> nowhere(3 * std::size_t{mesh.output_count()}, 0.25f);
  const std::vector<float> none(nowhere.size(), 0.0f);
  for (const float x : carry_skin(mesh, carried, nowhere, none)) EXPECT_NEAR(x, 0.25f, 1e-6f);
}

TEST(SkinDistance, IsThatOfAPlate) {
  Character full;
  full.vertices.resize(4, 3);
  full.vertices << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0.25, 0.25, 0.003;
  Character plate = full;
  plate.triangles.resize(1, 3);
  plate.triangles << 0, 1, 2;
  const SkinDistance distance = skin_distance(full, plate);
  EXPECT_NEAR(distance.max, 3, 1e-9);
  EXPECT_NEAR(distance.rms, 1.5, 1e-9);
}

}  // namespace
}  // namespace bodyopt::trainer
