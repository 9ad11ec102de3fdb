#include <gtest/gtest.h>

#include "tests/simulate/limb.h"
#include "trainer/tets/loose_pieces.h"
#include "trainer/tets/tets.h"

namespace bodyopt::trainer {
namespace {

// Two limbs of different joints side by side. Six vertices of the first are carried by a tet of the second, as teeth by
// the other jaw: so many that it follows more of their joint than of its own.
TEST(CarryByOwnJoints, PartsApartAlongTheSkinAreNotCarriedByOneAnother) {
  Character both = make_two_limbs(2 * kTubeRadius + 0.002);
  const auto count = static_cast<int>(both.vertices.rows()), half = count / 2;
  for (int v = 0; v < count; ++v) both.weights[static_cast<std::size_t>(v)] = {{v < half ? 0u : 1u, 1.0}};
  const TetMesh mesh = tetrahedralise(both.vertices, both.triangles, 0.05);
  int shared = -1;
  for (int t = 0; t < mesh.tets.rows() && shared < 0; ++t) {
    const auto corner = mesh.tets.row(t).array();
    if ((corner >= half).all() && (corner < count).any()) shared = t;
  }
  ASSERT_GE(shared, 0);
  std::vector<EmbeddedPoint> skin = own_nodes(mesh, count);
  for (std::size_t v = 0; v < 6; ++v) skin[v] = {shared, Eigen::Vector4d::Constant(0.25)};
  const auto glued = [&] { return glued_vertices(both.vertices, both.triangles, both.weights, mesh, skin); };
  ASSERT_GE(glued().size(), 6u);
  for (const GluedVertex& vertex : glued()) {
    const bool is_of_first = vertex.vertex < static_cast<std::uint32_t>(half);
    EXPECT_EQ(vertex.joint, both.weights[static_cast<std::size_t>(is_of_first ? half : 0)].front().joint);
  }
  carry_by_own_joints(both.vertices, both.triangles, both.weights, mesh, skin);
  EXPECT_TRUE(glued().empty());
  for (std::size_t v = 0; v < 6; ++v) {
    for (int a = 0; a < 4; ++a) {
      const int node = mesh.tets(skin[v].tet, a);
      EXPECT_TRUE(node < half || node >= count) << "vertex " << v << " is carried by node " << node;
    }
    EXPECT_LT((rest_position(mesh, skin[v]).transpose() - both.vertices.row(static_cast<Eigen::Index>(v))).norm(),
              1e-9);
  }
}

}  // namespace
}  // namespace bodyopt::trainer
