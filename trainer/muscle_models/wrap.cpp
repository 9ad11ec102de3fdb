#include "trainer/muscle_models/wrap.h"

#include <cmath>
#include <numbers>

namespace bodyopt::muscle_models {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kTiny = 1e-15;

double cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

// Where the tangent from p touches the circle of this radius about the origin, the one that turns by `sign`.
Vector2d touch(const Vector2d& p, double radius, double sign) {
  const double square = p.squaredNorm();
  const double along = radius * radius / square;
  const double across = radius * std::sqrt(std::max(square - radius * radius, 0.0)) / square;
  return along * p + sign * across * Vector2d(p.y(), -p.x());
}

bool segments_cross(const Vector2d& a, const Vector2d& b, const Vector2d& c, const Vector2d& d) {
  const double determinant = cross(b - a, d - c);
  if (std::abs(determinant) < kTiny) return false;
  const double u = cross(c - a, d - c) / determinant, v = cross(c - a, b - a) / determinant;
  return u >= 0 && u <= 1 && v >= 0 && v <= 1;
}

// Of a point at the origin, that of the first axis.
Vector2d direction(const Vector2d& p) { return p.norm() > kTiny ? Vector2d(p.normalized()) : Vector2d::UnitX(); }

struct FlatArc {
  Vector2d from, to;
  double length;
};

std::optional<FlatArc> around_circle(double radius, const std::optional<Vector2d>& side, const Vector2d& start,
                                     const Vector2d& end) {
  const Vector2d line = end - start;
  if (start.norm() < radius || end.norm() < radius || line.squaredNorm() < kTiny) return std::nullopt;
  const double nearest = std::clamp(-start.dot(line) / line.squaredNorm(), 0.0, 1.0);
  const Vector2d closest = start + nearest * line;
  if (closest.norm() > radius && (!side || closest.dot(*side) >= 0)) return std::nullopt;

  // Both ways around: the better is nearer to the side, or without one the shorter, the second where they are as good;
  // never one that crosses itself.
  constexpr double kCrossed = -1e4;
  double best = -2 * -kCrossed;
  FlatArc arc{};
  double way = 0;
  for (const double sign : {1.0, -1.0}) {
    const Vector2d from = touch(start, radius, sign), to = touch(end, radius, -sign);
    double goodness = side ? (from + to).normalized().dot(*side) : -(from - to).squaredNorm();
    if (segments_cross(start, from, end, to)) goodness = kCrossed;
    if (goodness >= best) {
      best = goodness;
      arc = {from, to, 0};
      way = sign;
    }
  }
  if (best == kCrossed) return std::nullopt;
  double angle = std::acos(std::clamp(arc.from.dot(arc.to) / (radius * radius), -1.0, 1.0));
  if (cross(arc.from, arc.to) * way > 0) angle = 2 * std::numbers::pi - angle;
  arc.length = radius * angle;
  return arc;
}

// The shortest way from start to end that touches the circle: it leaves the touching point at the angle at which it
// meets it, alpha to the radius. With z = sin(alpha), the sines' law in the triangles (centre, end, touching point)
// gives their angles at the centre, asin(z) - asin(z radius / distance), which add up to the angle between the ends.
std::optional<FlatArc> through_circle(double radius, const Vector2d& start, const Vector2d& end) {
  const Vector2d line = end - start;
  const double a = radius / start.norm(), b = radius / end.norm();
  if (!(a < 1 && b < 1) || line.squaredNorm() < kTiny) return std::nullopt;
  const double nearest = std::clamp(-start.dot(line) / line.squaredNorm(), 0.0, 1.0);
  if ((start + nearest * line).norm() <= radius) return std::nullopt;  // it passes inside as it is
  const double angle = std::atan2(cross(start, end), start.dot(end));
  const auto too_small = [&](double z) {
    return std::asin(a * z) + std::asin(b * z) - 2 * std::asin(z) + std::abs(angle) > 0;
  };
  // So near to a tangent MuJoCo's solver gives up and takes the point below the middle between the ends; its models
  // are fitted to the lengths it computes.
  constexpr double kGrazing = 1 - 1e-7;
  Vector2d touching = radius * (start + end).normalized();
  if (!too_small(kGrazing)) {
    double low = 0, high = kGrazing;
    for (int step = 0; step < 60; ++step) {
      const double z = 0.5 * (low + high);
      (too_small(z) ? low : high) = z;
    }
    const double turn = std::copysign(std::asin(low) - std::asin(a * low), angle);
    touching = radius * (Eigen::Rotation2Dd(turn) * start.normalized());
  }
  return FlatArc{touching, touching, 0};
}

using Plane = Eigen::Matrix<double, 2, 3>;  // two axes

// Through a sphere's centre and both ends; where these three are on a line, also through the side.
Plane plane_through(const std::optional<Vector3d>& side, const Vector3d& start, const Vector3d& end) {
  const Vector3d along = start.normalized();
  Vector3d normal = start.cross(end);
  if (!(normal.norm() > kTiny) && side) normal = start.cross(*side);
  if (!(normal.norm() > kTiny)) normal = along.unitOrthogonal();
  Plane plane;
  plane << along.transpose(), normal.normalized().cross(along).transpose();
  return plane;
}

}  // namespace

std::optional<Arc> wrap_around(Wrap::Shape shape, double radius, const std::optional<Vector3d>& side,
                               const Vector3d& start, const Vector3d& end) {
  if (!(start.norm() > kTiny && end.norm() > kTiny)) return std::nullopt;
  const Plane plane = shape == Wrap::Shape::sphere ? plane_through(side, start, end) : Plane::Identity();
  std::optional<FlatArc> flat;
  if (side && side->norm() < radius) {
    flat = through_circle(radius, plane * start, plane * end);
  } else {
    std::optional<Vector2d> flat_side;
    if (side) flat_side = direction(plane * *side);
    flat = around_circle(radius, flat_side, plane * start, plane * end);
  }
  if (!flat) return std::nullopt;
  Arc arc{plane.transpose() * flat->from, plane.transpose() * flat->to, flat->length};
  if (shape == Wrap::Shape::cylinder) {  // a helix: height grows with the length across
    const double before = (plane * start - flat->from).norm(), after = (plane * end - flat->to).norm();
    const double rise = (end.z() - start.z()) / (before + flat->length + after);
    arc.from.z() = start.z() + rise * before;
    arc.to.z() = start.z() + rise * (before + flat->length);
    arc.length = std::hypot(flat->length, rise * flat->length);
  }
  return arc;
}

}  // namespace bodyopt::muscle_models
