#include "geometry/thickness.h"

#include <gtest/gtest.h>

#include "tests/anatomy/egg_human.h"
#include "tests/simulate/limb.h"

namespace bodyopt {
namespace {

TEST(Thickness, OfATubeIsItsDiameter) {
  const Character limb = make_limb();
  const Eigen::VectorXd thick = thickness(limb.vertices, limb.triangles);
  const Eigen::Index middle = kTubeSides * (kTubeRings / 2);
  for (Eigen::Index v = middle; v < middle + kTubeSides; ++v)
    EXPECT_NEAR(thick[v], 2 * kTubeRadius, 0.08 * kTubeRadius);
}

TEST(Thickness, DoesNotDependOnTheWinding) {
  const Character limb = make_limb();
  const Triangles inside_out = limb.triangles.rowwise().reverse();
  EXPECT_LT((thickness(limb.vertices, inside_out) - thickness(limb.vertices, limb.triangles)).cwiseAbs().maxCoeff(),
            1e-9);
}

// Of an egg its short half axis, in the middle of its height.
TEST(HalfThickness, IsThatOfTheBodyBehind) {
  const Character egg = egg_human();
  const NearestSkin skin(egg.vertices, egg.triangles);
  const Eigen::VectorXd half = half_thickness(egg.vertices, egg.triangles, skin);
  EXPECT_GT(half.minCoeff(), 0);
  for (Eigen::Index v = 0; v < half.size(); ++v) {
    const bool is_in_the_middle = std::abs(egg.vertices(v, 1) - 0.875) < 0.1 && std::abs(egg.vertices(v, 0)) < 0.05;
    if (is_in_the_middle) {
      EXPECT_NEAR(half[v], 0.2, 0.025);
    }
  }
}

// As thin as anything is taken to be: no NaN, nor does it spread.
TEST(Thickness, OfALooseVertexIsTheLeast) {
  Character limb = make_limb();
  const Eigen::Index count = limb.vertices.rows();
  limb.vertices.conservativeResize(count + 1, 3);
  limb.vertices.row(count) << 0.25, 0, 0;
  const Eigen::VectorXd thick = thickness(limb.vertices, limb.triangles);
  EXPECT_NEAR(thick[count], kTubeLength / 180, 1e-9);
  EXPECT_EQ(thick.head(count), thickness(limb.vertices.topRows(count), limb.triangles));
}

// Rays along an axis at triangles that lie across it, whose boxes have no depth.
TEST(Thickness, OfASlabIsItsHeight) {
  constexpr int kCells = 12;
  constexpr double kHeight = 0.1;
  Positions vertices(2 * (kCells + 1) * (kCells + 1), 3);
  std::vector<std::array<std::uint32_t, 3>> faces;
  const auto number = [](int side, int i, int j) {
    return static_cast<std::uint32_t>((side * (kCells + 1) + i) * (kCells + 1) + j);
  };
  const auto add_square = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    faces.push_back({a, b, c});
    faces.push_back({a, c, d});
  };
  for (int i = 0; i <= kCells; ++i) {
    for (int j = 0; j <= kCells; ++j) {
      for (const int side : {0, 1}) vertices.row(number(side, i, j)) << i / 12.0, side * kHeight, j / 12.0;
    }
  }
  for (int i = 0; i < kCells; ++i) {
    for (int j = 0; j < kCells; ++j) {
      add_square(number(0, i, j), number(0, i + 1, j), number(0, i + 1, j + 1), number(0, i, j + 1));
      add_square(number(1, i, j), number(1, i, j + 1), number(1, i + 1, j + 1), number(1, i + 1, j));
    }
    add_square(number(0, i, 0), number(1, i, 0), number(1, i + 1, 0), number(0, i + 1, 0));
    add_square(number(0, i, kCells), number(0, i + 1, kCells), number(1, i + 1, kCells), number(1, i, kCells));
    add_square(number(0, 0, i), number(0, 0, i + 1), number(1, 0, i + 1), number(1, 0, i));
    add_square(number(0, kCells, i), number(1, kCells, i), number(1, kCells, i + 1), number(0, kCells, i + 1));
  }
  Triangles triangles(static_cast<Eigen::Index>(faces.size()), 3);
  for (std::size_t t = 0; t < faces.size(); ++t) {
    triangles.row(static_cast<Eigen::Index>(t)) << faces[t][0], faces[t][1], faces[t][2];
  }
  const Eigen::VectorXd thick = thickness(vertices, triangles, 0);
  for (int i = 3; i <= kCells - 3; ++i) {
    for (int j = 3; j <= kCells - 3; ++j) {
      for (const int side : {0, 1}) EXPECT_NEAR(thick[number(side, i, j)], kHeight, 1e-12) << i << " " << j;
    }
  }
}

}  // namespace
}  // namespace bodyopt
