#include "trainer/builtin/implicit.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace bodyopt {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

DistanceSample sample(const RoundedPart& part, const Vector3d& point) {
  const Vector3d q = part.to_local * (point - part.start);
  double t = 0;
  double radius = part.start_radius;
  if (part.length > 0) {
    // The sphere of the swept family that touches the distance level of q is shifted towards the wider end.
    const double slope = (part.end_radius - part.start_radius) / part.length;
    const double across = std::sqrt(q.y() * q.y() + q.z() * q.z());
    t = std::clamp(q.x() + slope * across / std::sqrt(1 - slope * slope), 0.0, part.length);
    const double part_way = t / part.length;
    radius += slope * t + part.bulge * 6.75 * part_way * (1 - part_way) * (1 - part_way);
  }
  const Vector3d out = q - Vector3d(t, 0, 0);
  const double reach = std::max(out.norm(), 1e-9);
  const Vector3d gradient = part.to_local.transpose() * (out / reach);
  // Dividing by the gradient's length makes the stretched distance a metric one near the surface.
  const double scale = std::max(gradient.norm(), 1e-9);
  return {(reach - radius) / scale, gradient / scale};
}

// Quadratic smooth minimum (Quilez): differs from min() only where the two are closer than `blend`.
DistanceSample smooth_min(const DistanceSample& a, const DistanceSample& b, double blend) {
  const DistanceSample& low = a.distance < b.distance ? a : b;
  const DistanceSample& high = a.distance < b.distance ? b : a;
  const double h = std::max(blend - (high.distance - low.distance), 0.0) / blend;
  return {low.distance - 0.25 * h * h * blend, (1 - 0.5 * h) * low.gradient + 0.5 * h * high.gradient};
}

DistanceSample negated(const DistanceSample& a) { return {-a.distance, -a.gradient}; }

Matrix3d frame(const Vector3d& along, const Vector3d& across) {
  Matrix3d rows;
  rows.row(0) = along.normalized();
  rows.row(1) = (across - across.dot(along) / along.squaredNorm() * along).normalized();
  rows.row(2) = rows.row(0).cross(rows.row(1));
  return rows;
}

DistanceSample sample(const std::vector<RoundedPart>& parts, const Vector3d& point) {
  DistanceSample total{1e3, Vector3d::UnitY()};
  for (const RoundedPart& part : parts) {
    const DistanceSample own = sample(part, point);
    total = part.keep_inside ? negated(smooth_min(negated(total), negated(own), part.blend))
                             : smooth_min(total, own, part.blend);
  }
  return total;
}

std::vector<RoundedPart> parts_near(const std::vector<RoundedPart>& parts, const Vector3d& point, double margin) {
  const double reach = sample(parts, point).distance + margin;
  std::vector<RoundedPart> near;
  for (const RoundedPart& part : parts) {
    if (part.keep_inside || sample(part, point).distance < reach) near.push_back(part);
  }
  return near;
}

}  // namespace

RoundedPart limb(const Vector3d& a, const Vector3d& b, double radius_a, double radius_b, double blend,
                 const Vector3d& flat_axis, double flat) {
  const Vector3d along = b - a;
  const Vector3d across = flat_axis.isZero() ? along.unitOrthogonal() : flat_axis;
  RoundedPart part;
  part.to_local = Vector3d(1, 1 / flat, 1).asDiagonal() * frame(along, across);
  part.start = a;
  part.length = along.norm();
  part.start_radius = radius_a;
  part.end_radius = radius_b;
  part.blend = blend;
  return part;
}

RoundedPart spindle(const Vector3d& a, const Vector3d& b, double radius_a, double radius_b, double bulge,
                    double blend) {
  RoundedPart part = limb(a, b, radius_a, radius_b, blend);
  part.bulge = bulge;
  return part;
}

RoundedPart belly(const Vector3d& centre, const Vector3d& along, const Vector3d& across, const Vector3d& half,
                  double blend) {
  RoundedPart part;
  part.to_local = half.cwiseInverse().asDiagonal() * frame(along, across);
  part.start = centre;
  part.blend = blend;
  return part;
}

Solid::Solid(std::vector<RoundedPart> parts, const Vector3d& low, const Vector3d& high)
    : parts_(std::move(parts)), low_(low) {
  for (int k = 0; k < 3; ++k) cells_[k] = static_cast<int>(std::ceil((high - low)[k] / kCell));
  double widest_blend = 0;
  for (const RoundedPart& part : parts_) widest_blend = std::max(widest_blend, part.blend);
  // From a cell's centre to its corner, distances change by the way walked, both the part's and the solid's; stretched
  // parts, whose distances are exact only near their surface, change a little more.
  const double margin = 1.4 * std::sqrt(3.0) * kCell + widest_blend;
  near_.reserve(static_cast<std::size_t>(cells_.prod()));
  for (int z = 0; z < cells_.z(); ++z) {
    for (int y = 0; y < cells_.y(); ++y) {
      for (int x = 0; x < cells_.x(); ++x) {
        near_.push_back(parts_near(parts_, low_ + kCell * Vector3d(x + 0.5, y + 0.5, z + 0.5), margin));
      }
    }
  }
}

int Solid::cell_of(const Vector3d& point) const {
  const Eigen::Vector3i at = ((point - low_) / kCell).array().floor().cast<int>();
  if ((at.array() < 0).any() || (at.array() >= cells_.array()).any()) return -1;
  return at.x() + cells_.x() * (at.y() + cells_.y() * at.z());
}

DistanceSample Solid::sample(const Vector3d& point) const {
  const int cell = near_.empty() ? -1 : cell_of(point);
  return bodyopt::sample(cell < 0 ? parts_ : near_[cell], point);
}

Vector3d Solid::project(Vector3d point, double depth) const {
  for (int step = 0; step < 12; ++step) {
    const DistanceSample at = sample(point);
    const double miss = at.distance + depth;
    if (std::abs(miss) < 1e-7) break;
    point -= miss / std::max(at.gradient.squaredNorm(), 0.25) * at.gradient;
  }
  return point;
}

}  // namespace bodyopt
