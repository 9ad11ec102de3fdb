#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <set>

#include "geometry/spatial_search.h"

namespace bodyopt {
namespace {

std::vector<Eigen::AlignedBox3d> random_boxes(int count) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(-1, 1), size(0, 0.6);
  std::vector<Eigen::AlignedBox3d> boxes;
  for (int k = 0; k < count; ++k) {
    const Eigen::Vector3d low(place(random), place(random), place(random));
    boxes.emplace_back(low, low + Eigen::Vector3d(size(random), size(random), size(random)));
  }
  return boxes;
}

TEST(BoxTree, FindsTheNearestBoxAndLooksAtFew) {
  for (const int count : {1, 2, 3, 500}) {
    const std::vector<Eigen::AlignedBox3d> boxes = random_boxes(count);
    const BoxTree tree(boxes);
    std::mt19937 random(8);
    std::uniform_real_distribution<double> place(-2, 2);
    int considered = 0;
    for (int k = 0; k < 50; ++k) {
      const Eigen::Vector3d point(place(random), place(random), place(random));
      double expected = std::numeric_limits<double>::infinity(), least = expected;
      for (const Eigen::AlignedBox3d& box : boxes) expected = std::min(expected, box.exteriorDistance(point));
      const auto bound = [&](const Eigen::AlignedBox3d& box) { return box.exteriorDistance(point); };
      const auto consider = [&](int number) {
        ++considered;
        return least = std::min(least, boxes[static_cast<std::size_t>(number)].exteriorDistance(point));
      };
      tree.search(bound, consider, least);
      EXPECT_EQ(least, expected) << count;
    }
    if (count == 500) {
      EXPECT_LT(considered, 50 * count / 10);
    }
  }
}

TEST(BoxTree, ConsidersEachBoxOfABoundThatIsNotAbove) {
  const std::vector<Eigen::AlignedBox3d> boxes = random_boxes(200);
  const BoxTree tree(boxes);
  std::size_t found_of_all = 0;
  for (const Eigen::AlignedBox3d& of : boxes) {
    const Eigen::Vector3d point = of.center();
    std::set<int> expected, found;
    for (int k = 0; k < 200; ++k) {
      if (boxes[static_cast<std::size_t>(k)].contains(point)) expected.insert(k);
    }
    const auto consider = [&](int number) {
      if (boxes[static_cast<std::size_t>(number)].contains(point)) found.insert(number);
      return 0.0;
    };
    tree.search([&](const Eigen::AlignedBox3d& box) { return box.contains(point) ? 0.0 : 1.0; }, consider, 0);
    EXPECT_EQ(found, expected);
    found_of_all += found.size();
  }
  EXPECT_GT(found_of_all, boxes.size());  // more than the box that the point is of
}

}  // namespace
}  // namespace bodyopt
