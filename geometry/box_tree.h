// Searches in space: a hierarchy of boxes, of which only those are opened that may hold something better than the best
// found (branch and bound).
#pragma once

#include <Eigen/Geometry>
#include <numeric>
#include <unsupported/Eigen/BVH>
#include <utility>
#include <vector>

#include "geometry/mesh.h"

namespace bodyopt {

class BoxTree {
 public:
  // One box or more: of triangles, tets or what else has a place.
  explicit BoxTree(const std::vector<Eigen::AlignedBox3d>& boxes) {
    std::vector<int> numbers(boxes.size());
    std::iota(numbers.begin(), numbers.end(), 0);
    tree_.init(numbers.begin(), numbers.end(), boxes.begin(), boxes.end());
  }

  // bound(box): what nothing in the box can be less than. consider(number): looks at what the box of that number holds
  // and returns the least found so far. All are considered whose bound is at most `least`, in no certain order.
  template <typename Bound, typename Consider>
  void search(const Bound& bound, const Consider& consider, double least) const {
    search(tree_.getRootIndex(), bound, consider, least);
  }

 private:
  template <typename Bound, typename Consider>
  void search(int node, const Bound& bound, const Consider& consider, double& least) const {
    const int *child = nullptr, *children_end = nullptr, *number = nullptr, *numbers_end = nullptr;
    tree_.getChildren(node, child, children_end, number, numbers_end);
    for (; number != numbers_end; ++number) least = consider(*number);
    if (child == children_end) return;
    std::pair<double, int> first(bound(tree_.getVolume(*child)), *child), second = first;
    const bool has_two = children_end - child == 2;
    if (has_two) second = {bound(tree_.getVolume(child[1])), child[1]};
    if (second < first) std::swap(first, second);  // what is nearer spares most of what is farther
    if (first.first <= least) search(first.second, bound, consider, least);
    if (has_two && second.first <= least) search(second.second, bound, consider, least);
  }

  Eigen::KdBVH<double, 3, int> tree_;
};

// Of each triangle or tet: rows of `elements` number their corners.
template <typename Elements>
std::vector<Eigen::AlignedBox3d> boxes_of(const Positions& vertices, const Elements& elements) {
  std::vector<Eigen::AlignedBox3d> boxes(static_cast<std::size_t>(elements.rows()));
  for (std::size_t k = 0; k < boxes.size(); ++k) {
    for (const auto corner : elements.row(static_cast<Eigen::Index>(k)))
      boxes[k].extend(vertices.row(corner).transpose());
  }
  return boxes;
}

}  // namespace bodyopt
