#include <gtest/gtest.h>

#include "geometry/self_intersections.h"

namespace bodyopt::testing {
namespace skin_in_skin_test {

// Cubes beside each other in one mesh, wound outwards.
struct Cubes {
  void add(const Eigen::RowVector3d& low, double edge) {
    const auto first = static_cast<std::uint32_t>(vertices.rows());
    vertices.conservativeResize(first + 8, 3);
    for (int k = 0; k < 8; ++k) {
      vertices.row(first + k) = low + edge * Eigen::RowVector3d(k & 1, k >> 1 & 1, k >> 2 & 1);
    }
    const std::uint32_t corners[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                          {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    triangles.conservativeResize(triangles.rows() + 12, 3);
    for (int t = 0; t < 12; ++t) {
      for (int k = 0; k < 3; ++k) triangles(triangles.rows() - 12 + t, k) = first + corners[t][k];
    }
  }

  std::vector<BuriedVertex> buried() const { return skin_in_skin(vertices, triangles); }

  Positions vertices{0, 3};
  Triangles triangles{0, 3};
};

TEST(SkinInSkin, IsAsDeepAsACubeIsPressedIntoAnother) {
  Cubes cubes;
  cubes.add({0, 0, 0}, 1);
  cubes.add({0.8, 0.31, 0.32}, 0.4);
  const std::vector<BuriedVertex> buried = cubes.buried();
  ASSERT_EQ(buried.size(), 4u);  // those of the small one's side at x = 0.8
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(buried[k].vertex, 8 + 2 * k);
    EXPECT_NEAR(buried[k].depth, 0.2, 1e-12);
  }
}

TEST(SkinInSkin, IsNoneOfSkinThatIsApart) {
  Cubes cubes;
  cubes.add({0, 0, 0}, 1);
  cubes.add({1.1, 0.31, 0.32}, 0.4);
  EXPECT_TRUE(cubes.buried().empty());
}

}  // namespace skin_in_skin_test
}  // namespace bodyopt::testing
