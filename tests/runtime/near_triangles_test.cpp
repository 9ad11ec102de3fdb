#include <gtest/gtest.h>

#include <algorithm>

#include "runtime/host/character_model.h"
#include "tests/support/random_tables.h"

namespace bodyopt::testing {
namespace near_triangles_test {

TEST(NearTriangles, StandInTheOrderOfTheirVertices) {
  Random random(3);
  const MeshTable mesh = random_mesh(random, 500);
  const NearTriangles near = near_triangles(mesh);
  ASSERT_EQ(near.triangles.size(), mesh.triangles.size());
  std::uint32_t last = 0;
  for (std::size_t t = 0; t < near.triangles.size(); t += 3) {
    const std::uint32_t lowest = *std::min_element(&near.triangles[t], &near.triangles[t] + 3);
    EXPECT_LE(last, lowest);
    last = lowest;
  }
  EXPECT_GT(last, 400u);
}

TEST(NearTriangles, OfAVertexAreThoseOfTheMeshInItsOrder) {
  Random random(4);
  const MeshTable mesh = random_mesh(random, 500);
  const NearTriangles near = near_triangles(mesh);
  ASSERT_EQ(near.vertex_triangles.size(), mesh.vertex_triangles.size());
  for (std::size_t k = 0; k < mesh.vertex_triangles.size(); ++k) {
    const std::uint32_t* const found = &near.triangles[3 * near.vertex_triangles[k]];
    EXPECT_TRUE(std::equal(found, found + 3, &mesh.triangles[3 * mesh.vertex_triangles[k]])) << k;
  }
}

}  // namespace near_triangles_test
}  // namespace bodyopt::testing
