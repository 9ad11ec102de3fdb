#include "bench/subdivide.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <map>

#include "tests/simulate/limb.h"
#include "trainer/check/check.h"
#include "trainer/train/skinning/unpose.h"

namespace bodyopt::bench {
namespace {

using namespace trainer;

double volume(const Character& character) {
  double sum = 0;
  for (Eigen::Index t = 0; t < character.triangles.rows(); ++t) {
    const auto corner = [&](int k) { return Eigen::Vector3d(character.vertices.row(character.triangles(t, k))); };
    sum += corner(0).dot(corner(1).cross(corner(2))) / 6;
  }
  return sum;
}

double longest_edge(const Character& character) {
  double longest = 0;
  for (Eigen::Index t = 0; t < character.triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const auto a = character.triangles(t, k), b = character.triangles(t, (k + 1) % 3);
      longest = std::max(longest, (character.vertices.row(a) - character.vertices.row(b)).norm());
    }
  }
  return longest;
}

// Of the k-th edge halved.
double edge_length(const Subdivision& subdivision, std::size_t k) {
  const auto [a, b] = subdivision.parents[k];
  return (subdivision.character.vertices.row(a) - subdivision.character.vertices.row(b)).norm();
}

// What every subdivision of the limb must be: the same closed surface with middles on its edges.
void expect_finer_limb(const Subdivision& subdivision) {
  const Character limb = make_limb();
  const Character& fine = subdivision.character;
  const Eigen::Index coarse = limb.vertices.rows();
  ASSERT_EQ(fine.vertices.rows(), coarse + static_cast<Eigen::Index>(subdivision.parents.size()));
  EXPECT_EQ(fine.triangles.rows(), 2 * (fine.vertices.rows() - 2));  // Euler: of a sphere
  EXPECT_EQ(describe_surface(fine), "closed, 1 piece");
  EXPECT_NEAR(volume(fine), volume(limb), 1e-12);
  EXPECT_EQ(fine.vertices.topRows(coarse), limb.vertices);
  ASSERT_EQ(fine.weights.size(), static_cast<std::size_t>(fine.vertices.rows()));
  ASSERT_EQ(fine.output_count(), fine.weights.size());
  for (std::size_t k = 0; k < subdivision.parents.size(); ++k) {
    const auto [a, b] = subdivision.parents[k];
    const std::size_t v = static_cast<std::size_t>(coarse) + k;
    ASSERT_LT(std::max(a, b), v);
    std::map<std::uint32_t, double> expected;
    for (const std::uint32_t parent : {a, b}) {
      for (const JointWeight& w : fine.weights[parent]) expected[w.joint] += w.weight / 2;
    }
    double sum = 0;
    for (const JointWeight& w : fine.weights[v]) {
      EXPECT_NEAR(w.weight, expected[w.joint], 1e-15);
      sum += w.weight;
    }
    EXPECT_NEAR(sum, 1, 1e-12);
  }
  // Shapes follow: a posed shape's middles are the middles of the posed shape.
  const Positions posed = skin_linear(limb, bent(limb, 1.0));
  const Positions finer = with_middles(posed, subdivision);
  for (std::size_t k = 0; k < subdivision.parents.size(); ++k) {
    const auto [a, b] = subdivision.parents[k];
    EXPECT_LT((2 * finer.row(coarse + static_cast<Eigen::Index>(k)) - finer.row(a) - finer.row(b)).norm(), 1e-15);
  }
}

TEST(Subdivide, LongestEdgesAreHalvedUntilThereAreEnough) {
  const Character limb = make_limb();
  const Subdivision subdivision = halve_longest_edges(limb, 1000);
  EXPECT_EQ(subdivision.character.vertices.rows(), 1000);
  expect_finer_limb(subdivision);
  // Half an edge and the line to the corner opposite are no longer than the longest edge of the triangle: lengths fall.
  double last = longest_edge(limb);
  EXPECT_EQ(edge_length(subdivision, 0), last);
  for (std::size_t k = 0; k < subdivision.parents.size(); ++k) {
    EXPECT_LE(edge_length(subdivision, k), last + 1e-12);
    last = edge_length(subdivision, k);
  }
  EXPECT_LE(longest_edge(subdivision.character), last + 1e-12);
  EXPECT_EQ(halve_longest_edges(limb, 10).parents.size(), 0u);
}

TEST(Subdivide, AllEdgesAreHalved) {
  const Character limb = make_limb();
  const Subdivision subdivision = halve_all_edges(limb);
  EXPECT_EQ(subdivision.character.triangles.rows(), 4 * limb.triangles.rows());
  expect_finer_limb(subdivision);
  EXPECT_NEAR(longest_edge(subdivision.character), longest_edge(limb) / 2, 1e-12);
}

}  // namespace
}  // namespace bodyopt::bench
