#include "trainer/train/closest_point.h"

#include <algorithm>
#include <limits>

namespace bodyopt {
namespace {

// Barycentric weights of the point of segment ab nearest to p.
double along(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& p) {
  const Eigen::Vector3d edge = b - a;
  const double length2 = edge.squaredNorm();
  return length2 > 0 ? std::clamp((p - a).dot(edge) / length2, 0.0, 1.0) : 0.0;
}

// Inside the triangle when the projection falls there, else the nearest of the three edges.
Eigen::Vector3d closest_weights(const Eigen::Vector3d (&c)[3], const Eigen::Vector3d& p) {
  const Eigen::Vector3d u = c[1] - c[0], v = c[2] - c[0], w = p - c[0];
  const double uu = u.dot(u), uv = u.dot(v), vv = v.dot(v), uw = u.dot(w), vw = v.dot(w);
  const double determinant = uu * vv - uv * uv;
  if (determinant > 1e-14 * uu * vv) {
    const double s = (vv * uw - uv * vw) / determinant, t = (uu * vw - uv * uw) / determinant;
    if (s >= 0 && t >= 0 && s + t <= 1) return {1 - s - t, s, t};
  }
  Eigen::Vector3d best(1, 0, 0);
  double best_distance = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3;
    const double t = along(c[k], c[next], p);
    const double distance = (c[k] + t * (c[next] - c[k]) - p).squaredNorm();
    if (distance >= best_distance) continue;
    best_distance = distance;
    best.setZero();
    best[k] = 1 - t;
    best[next] = t;
  }
  return best;
}

}  // namespace

ClosestPoint::ClosestPoint(const MeshTable& mesh) : mesh_(mesh) {
  for (std::size_t t = 0; t < mesh.triangles.size() / 3; ++t) {
    const Eigen::Vector3d centre = (corner(t, 0) + corner(t, 1) + corner(t, 2)) / 3;
    double radius = 0;
    for (int k = 0; k < 3; ++k) radius = std::max(radius, (corner(t, k) - centre).norm());
    spheres_.push_back({centre, radius});
  }
}

Eigen::Vector3d ClosestPoint::corner(std::size_t triangle, int k) const {
  const std::size_t v = mesh_.triangles[3 * triangle + static_cast<std::size_t>(k)];
  return {mesh_.rest[3 * v], mesh_.rest[3 * v + 1], mesh_.rest[3 * v + 2]};
}

SurfacePoint ClosestPoint::find(const Eigen::Vector3d& point) const {
  SurfacePoint best;
  best.distance = std::numeric_limits<double>::infinity();
  for (std::size_t t = 0; t < spheres_.size(); ++t) {
    const double reach = best.distance + spheres_[t].radius;
    if ((spheres_[t].centre - point).squaredNorm() >= reach * reach) continue;
    const Eigen::Vector3d corners[3] = {corner(t, 0), corner(t, 1), corner(t, 2)};
    const Eigen::Vector3d weights = closest_weights(corners, point);
    const Eigen::Vector3d position = weights[0] * corners[0] + weights[1] * corners[1] + weights[2] * corners[2];
    const double distance = (position - point).norm();
    if (distance < best.distance) best = {static_cast<std::uint32_t>(t), weights, position, distance};
  }
  return best;
}

}  // namespace bodyopt
