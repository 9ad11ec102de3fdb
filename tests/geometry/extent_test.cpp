#include <gtest/gtest.h>

#include "geometry/mesh.h"

namespace bodyopt {
namespace {

TEST(Extent, IsOfTheBoxAroundThePoints) {
  Positions points(3, 3);
  points << 1, -1, 0, 4, 2, 1, 2, 3, -11;
  EXPECT_EQ(box_sides(points), Eigen::RowVector3d(3, 4, 12));
  EXPECT_EQ(longest_extent(points), 12);
  EXPECT_EQ(box_diagonal(points), 13);
}

TEST(Extent, OfNoPointsIsNone) {
  EXPECT_EQ(longest_extent(Positions(0, 3)), 0);
  EXPECT_EQ(box_diagonal(Positions(0, 3)), 0);
}

}  // namespace
}  // namespace bodyopt
