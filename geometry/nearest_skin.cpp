#include "geometry/nearest_skin.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <nanoflann.hpp>

namespace bodyopt {
namespace {

// Barycentric weights of the point of triangle abc nearest to p (Ericson, Real-Time Collision Detection, 5.1.5).
Eigen::Vector3d nearest_weights(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                const Eigen::Vector3d& c) {
  const Eigen::Vector3d ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return {1, 0, 0};
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return {0, 1, 0};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) {
    const double t = d1 - d3 > 0 ? d1 / (d1 - d3) : 0;
    return {1 - t, t, 0};
  }
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return {0, 0, 1};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) {
    const double t = d2 - d6 > 0 ? d2 / (d2 - d6) : 0;
    return {1 - t, 0, t};
  }
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const double edge = (d4 - d3) + (d5 - d6), t = edge > 0 ? (d4 - d3) / edge : 0;
    return {0, 1 - t, t};
  }
  const double sum = va + vb + vc;
  if (!(sum > 0)) return {1, 0, 0};
  return {va / sum, vb / sum, vc / sum};
}

// The nearest of the triangles offered to it, in the shape that nanoflann asks for: it goes on until no centre within
// worstDist is left.
template <typename Consider>
class NearestTriangle {
 public:
  NearestTriangle(const std::vector<double>& radius, double largest_radius, const Consider& consider)
      : radius_(radius), largest_radius_(largest_radius), consider_(consider) {}
  bool full() const { return true; }
  bool addPoint(double squared_distance, std::uint32_t triangle) {
    if (squared_distance <= square_of_reach(radius_[triangle])) {
      consider_(static_cast<Eigen::Index>(triangle), nearest_);
    }
    return true;
  }
  double worstDist() const { return square_of_reach(largest_radius_); }

 private:
  // From a point to centres whose triangles may be as near as the nearest.
  double square_of_reach(double radius) const {
    const double reach = nearest_ + radius;
    return reach * reach * (1 + 1e-12);
  }

  const std::vector<double>& radius_;
  double largest_radius_;
  double nearest_ = std::numeric_limits<double>::infinity();
  const Consider& consider_;
};

}  // namespace

class NearestSkin::CentreTree {
 public:
  explicit CentreTree(const Positions& points) : points_(points), index_(3, *this) {}
  std::size_t kdtree_get_point_count() const { return static_cast<std::size_t>(points_.rows()); }
  double kdtree_get_pt(std::size_t k, std::size_t axis) const {
    return points_(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(axis));
  }
  template <typename Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
  template <typename Results>
  void find(Results& results, const Eigen::Vector3d& point) const {
    index_.findNeighbors(results, point.data(), {});
  }

 private:
  const Positions& points_;
  nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, CentreTree>, CentreTree, 3, std::uint32_t>
      index_;
};

NearestSkin::NearestSkin(const Positions& vertices, const Triangles& triangles)
    : vertices_(vertices), triangles_(triangles), centres_(triangles.rows(), 3) {
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    const Positions corners = vertices(triangles.row(t), Eigen::all);
    centres_.row(t) = corners.colwise().sum() / 3;
    radius_.push_back((corners.rowwise() - centres_.row(t)).rowwise().norm().maxCoeff());
    largest_radius_ = std::max(largest_radius_, radius_.back());
  }
  tree_ = std::make_unique<CentreTree>(centres_);
}

NearestSkin::~NearestSkin() = default;

template <typename Wanted>
SkinPoint NearestSkin::search(const Eigen::Vector3d& point, const Wanted& wanted) const {
  SkinPoint best;
  const auto consider = [&](Eigen::Index t, double& best_distance) {
    const auto corners = triangles_.row(t);
    const Eigen::Vector3d a = vertices_.row(corners[0]), b = vertices_.row(corners[1]), c = vertices_.row(corners[2]);
    if (!wanted(a, b, c)) return;
    const Eigen::Vector3d weights = nearest_weights(point, a, b, c);
    const Eigen::Vector3d position = weights[0] * a + weights[1] * b + weights[2] * c;
    const double distance = (position - point).norm();
    if (!(distance < best_distance) && !(distance == best_distance && t < best.triangle)) return;
    best_distance = distance;
    best = {t, {corners[0], corners[1], corners[2]}, weights, position};
  };
  NearestTriangle nearest(radius_, largest_radius_, consider);
  tree_->find(nearest, point);
  return best;
}

SkinPoint NearestSkin::operator()(const Eigen::Vector3d& point) const {
  return search(point, [](const auto&...) { return true; });
}

SkinPoint NearestSkin::facing(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) const {
  return search(point, [&](const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
    return (b - a).cross(c - a).dot(normal) > 0;
  });
}

}  // namespace bodyopt
