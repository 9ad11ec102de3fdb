#include "geometry/skin_depth.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

namespace bodyopt {

using Eigen::Vector3d;

SkinDepth::SkinDepth(const Positions& vertices, const Triangles& triangles)
    : vertices_(vertices), triangles_(triangles), nearest_(vertices, triangles) {}

// The sum of the triangles' solid angles (Van Oosterom, Strackee 1983).
double SkinDepth::winding_number(const Vector3d& point) const {
  double sum = 0;
  for (Eigen::Index t = 0; t < triangles_.rows(); ++t) {
    const Vector3d a = vertices_.row(triangles_(t, 0)).transpose() - point;
    const Vector3d b = vertices_.row(triangles_(t, 1)).transpose() - point;
    const Vector3d c = vertices_.row(triangles_(t, 2)).transpose() - point;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    sum += std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return sum / (2 * std::numbers::pi);
}

double SkinDepth::operator()(const Vector3d& point) const {
  const double distance = (nearest_(point).position - point).norm();
  return std::abs(winding_number(point)) > 0.5 ? distance : -distance;
}

std::optional<Vector3d> SkinDepth::tuck(const Vector3d& point, double depth) const {
  const double here = (*this)(point);
  if (here >= depth) return point;
  const SkinPoint skin = nearest_(point);
  const Vector3d a = vertices_.row(skin.vertices[0]), b = vertices_.row(skin.vertices[1]);
  const Vector3d c = vertices_.row(skin.vertices[2]);
  Vector3d inward = -(b - a).cross(c - a).normalized();
  if (std::abs(here) > 1e-6) inward = (here > 0 ? 1 : -1) * (point - skin.position).normalized();
  Vector3d best = point;
  double deepest = here;
  for (int halvings = 0; halvings < 6; ++halvings, depth /= 2) {
    const Vector3d candidate = skin.position + depth * inward;
    const double reached = (*this)(candidate);
    if (reached > deepest) {
      best = candidate;
      deepest = reached;
    }
    if (deepest > 0.7 * depth) return best;
  }
  if (!(deepest > 0)) return std::nullopt;
  return best;
}

}  // namespace bodyopt
