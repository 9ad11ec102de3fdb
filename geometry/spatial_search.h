// Searches in space: a hierarchy of boxes, of which only those are opened that may hold something better than the best
// found (branch and bound).
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
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

  // bound(box): a lower bound for all that is in the box. consider(number): looks at what that box holds and returns
  // the least found so far. All are considered whose bound is at most `least`, in no certain order.
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

// Bounding boxes of triangles or tets, whose corners the rows of `elements` number.
template <typename Elements>
std::vector<Eigen::AlignedBox3d> boxes_of(const Positions& vertices, const Elements& elements) {
  std::vector<Eigen::AlignedBox3d> boxes(static_cast<std::size_t>(elements.rows()));
  for (std::size_t k = 0; k < boxes.size(); ++k) {
    for (const auto corner : elements.row(static_cast<Eigen::Index>(k)))
      boxes[k].extend(vertices.row(corner).transpose());
  }
  return boxes;
}

// Points sorted into the cells of a regular grid.

// `chosen`: rows of the points to sort in. cell: its edge, metres.
class PointGrid {
 public:
  PointGrid(const Positions& points, const std::vector<int>& chosen, double cell) : cell_(cell) {
    const Positions own = points(chosen, Eigen::all);
    origin_ = own.colwise().minCoeff().transpose();
    const Eigen::Vector3d extent = own.colwise().maxCoeff().transpose() - origin_;
    constexpr double kMostCells = 200;
    cell_ = std::max(cell_, extent.maxCoeff() / kMostCells);
    for (int i = 0; i < 3; ++i) size_[i] = static_cast<int>(extent[i] / cell_) + 1;
    begin_.assign(static_cast<std::size_t>(size_[0]) * static_cast<std::size_t>(size_[1] * size_[2]) + 1, 0);
    for (const int n : chosen) ++begin_[cell_of(points, n) + 1];
    for (std::size_t c = 1; c < begin_.size(); ++c) begin_[c] += begin_[c - 1];
    points_.resize(chosen.size());
    std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
    for (const int n : chosen) points_[next[cell_of(points, n)]++] = {points.row(n), n};
  }

  // Calls visit(n) for every point in a box.
  template <typename Visit>
  void visit(const Eigen::RowVector3d& low, const Eigen::RowVector3d& high, Visit visit) const {
    int first[3], last[3];
    for (int i = 0; i < 3; ++i) {
      const double end = size_[i], from = std::floor((low[i] - origin_[i]) / cell_),
                   to = std::floor((high[i] - origin_[i]) / cell_);
      if (!(from < end) || !(to >= 0)) return;
      first[i] = static_cast<int>(std::max(from, 0.0));
      last[i] = static_cast<int>(std::min(to, end - 1));
    }
    for (int x = first[0]; x <= last[0]; ++x) {
      for (int y = first[1]; y <= last[1]; ++y) {
        const std::size_t begin = index(x, y, first[2]), end = index(x, y, last[2]) + 1;
        for (std::uint32_t k = begin_[begin]; k < begin_[end]; ++k) {
          if (inside(points_[k].position, low, high)) visit(points_[k].node);
        }
      }
    }
  }

 private:
  static bool inside(const Eigen::RowVector3d& point, const Eigen::RowVector3d& low, const Eigen::RowVector3d& high) {
    return (point.array() >= low.array()).all() && (point.array() <= high.array()).all();
  }
  struct Point {
    Eigen::RowVector3d position;
    int node;
  };
  std::size_t index(int x, int y, int z) const {
    return (static_cast<std::size_t>(x) * static_cast<std::size_t>(size_[1]) + static_cast<std::size_t>(y)) *
               static_cast<std::size_t>(size_[2]) +
           static_cast<std::size_t>(z);
  }
  std::size_t cell_of(const Positions& points, int n) const {
    int at[3];
    for (int i = 0; i < 3; ++i) at[i] = std::min(static_cast<int>((points(n, i) - origin_[i]) / cell_), size_[i] - 1);
    return index(at[0], at[1], at[2]);
  }

  double cell_;
  Eigen::Vector3d origin_;
  int size_[3];
  std::vector<std::uint32_t> begin_;
  std::vector<Point> points_;
};

}  // namespace bodyopt
