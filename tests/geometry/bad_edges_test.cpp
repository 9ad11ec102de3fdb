#include <gtest/gtest.h>

#include <array>

#include "geometry/surface_topology.h"

namespace bodyopt {
namespace {

using Edges = std::vector<VertexPair>;

Triangles triangles_of(std::initializer_list<std::array<std::uint32_t, 3>> list) {
  Triangles triangles(static_cast<Eigen::Index>(list.size()), 3);
  Eigen::Index t = 0;
  for (const auto& [a, b, c] : list) triangles.row(t++) << a, b, c;
  return triangles;
}

TEST(BadEdges, OfASquareAreItsRim) {
  const BadEdges bad = find_bad_edges(triangles_of({{0, 1, 2}, {0, 2, 3}}));
  EXPECT_EQ(bad.open, (Edges{{0, 1}, {0, 3}, {1, 2}, {2, 3}}));
  EXPECT_EQ(bad.shared, Edges{});
  EXPECT_EQ(bad.flipped, Edges{});
}

TEST(BadEdges, TrianglesThatWindOppositelyFlipTheirEdge) {
  const BadEdges bad = find_bad_edges(triangles_of({{0, 1, 2}, {0, 3, 2}}));
  EXPECT_EQ(bad.flipped, (Edges{{0, 2}}));
  EXPECT_EQ(bad.shared, Edges{});
}

TEST(BadEdges, AThirdTriangleMakesAnEdgeShared) {
  const BadEdges bad = find_bad_edges(triangles_of({{0, 1, 2}, {0, 2, 3}, {0, 2, 4}}));
  EXPECT_EQ(bad.shared, (Edges{{0, 2}}));
  EXPECT_EQ(bad.flipped, Edges{});
  EXPECT_EQ(bad.open.size(), 6u);
}

TEST(BadEdges, WhatIsThereTwiceCountsOnceHoweverItWinds) {
  EXPECT_EQ(each_once(triangles_of({{0, 1, 2}, {2, 0, 1}, {0, 2, 3}, {2, 1, 0}})),
            triangles_of({{0, 1, 2}, {0, 2, 3}}));
}

}  // namespace
}  // namespace bodyopt
