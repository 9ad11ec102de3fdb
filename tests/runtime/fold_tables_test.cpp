#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "runtime/host/skin_tables.h"
#include "shaders/include/fold.h"
#include "tests/support/random_tables.h"

namespace bodyopt::testing {
namespace fold_tables_test {

std::vector<std::array<std::uint32_t, 3>> sorted(const std::vector<std::uint32_t>& triangles) {
  std::vector<std::array<std::uint32_t, 3>> found;
  for (std::size_t t = 0; t < triangles.size(); t += 3) {
    found.push_back({triangles[t], triangles[t + 1], triangles[t + 2]});
  }
  std::ranges::sort(found);
  return found;
}

// Triangles of two patches far from each other, in turns.
MeshTable two_patches() {
  MeshTable mesh;
  Random random(7);
  for (std::uint32_t k = 0; k < 3 * 2 * 4 * kBoxTriangles; ++k) {
    mesh.triangles.push_back(k);
    for (std::uint32_t i = 0; i < 3; ++i) {
      const double patch = i == 1 && k / 3 % 2 == 1 ? 10 : 0;
      mesh.rest.push_back(static_cast<float>(patch + random.uniform(0, 1)));
    }
  }
  return mesh;
}

TEST(FoldTables, HoldEachTriangleOnce) {
  Random random(3);
  for (const std::uint32_t vertices : {3u, 40u, 300u}) {
    const MeshTable mesh = random_mesh(random, vertices);
    EXPECT_EQ(sorted(boxed_triangles(mesh)), sorted(mesh.triangles)) << vertices;
  }
  EXPECT_TRUE(boxed_triangles({}).empty());
}

TEST(FoldTables, TrianglesOfABoxLieTogether) {
  const MeshTable mesh = two_patches();
  const std::vector<std::uint32_t> triangles = boxed_triangles(mesh);
  for (std::size_t t = 0; t < triangles.size() / 3; ++t) {
    EXPECT_EQ(triangles[3 * t] / 3 % 2, triangles[3 * (t / kBoxTriangles * kBoxTriangles)] / 3 % 2) << t;
  }
}

TEST(FoldTables, BoxesKnowTheSidesOfTheirCorners) {
  constexpr std::uint32_t kWords = 2;
  const MeshTable mesh = two_patches();
  const std::size_t vertices = mesh.vertex_count();
  FoldTables tables = {mesh.triangles, std::vector<std::uint32_t>(2 * kWords * vertices)};
  // Of fold 33 the corners of the first box are the child's, and one of the second box.
  for (std::uint32_t v = 0; v < 3 * kBoxTriangles + 1; ++v) tables.sides[2 * kWords * v + kWords + 1] = 1u << 1;
  add_box_sides(kWords, tables);
  ASSERT_EQ(tables.sides.size(),
            2 * kWords * (vertices + small_box_count(static_cast<std::uint32_t>(mesh.triangles.size() / 3))));
  const auto has = [&](std::size_t box, std::size_t list) {
    return (tables.sides[2 * kWords * (vertices + box) + list * kWords + 1] >> 1 & 1u) == 1u;
  };
  EXPECT_FALSE(has(0, 0));
  EXPECT_TRUE(has(0, 1));
  EXPECT_TRUE(has(1, 0));
  EXPECT_TRUE(has(1, 1));
  EXPECT_TRUE(has(2, 0));
  EXPECT_FALSE(has(2, 1));
}

}  // namespace fold_tables_test
}  // namespace bodyopt::testing
