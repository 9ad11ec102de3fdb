#include "trainer/muscle_models/model.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "runtime/core/error.h"
#include "runtime/core/transformed.h"

namespace bodyopt::trainer::muscle_models {
namespace {

// A sixth of the spline's second derivative at each knot.
std::vector<double> second_derivatives(const std::vector<double>& x, const std::vector<double>& y) {
  const std::size_t n = x.size();
  if (n < 3) return std::vector<double>(n, 0.0);
  std::vector<double> step(n - 1), diagonal(n), right(n, 0.0);
  std::vector<double> slope(n - 1);
  for (std::size_t i = 0; i + 1 < n; ++i) {
    step[i] = x[i + 1] - x[i];
    slope[i] = (y[i + 1] - y[i]) / step[i];
  }
  for (std::size_t i = 1; i + 1 < n; ++i) {
    diagonal[i] = 2 * (x[i + 1] - x[i - 1]);
    right[i] = slope[i] - slope[i - 1];
  }
  // The ends: minus the step times a sixth of the third derivative of the cubic through four points.
  diagonal[0] = -step[0];
  diagonal[n - 1] = -step[n - 2];
  if (n > 3) {
    const auto third = [&](std::size_t k) {  // divided difference over x[k] .. x[k + 3]
      return (right[k + 2] / (x[k + 3] - x[k + 1]) - right[k + 1] / (x[k + 2] - x[k])) / (x[k + 3] - x[k]);
    };
    const double first = third(0), last = third(n - 4);
    right[0] = step[0] * step[0] * first;
    right[n - 1] = -step[n - 2] * step[n - 2] * last;
  }
  for (std::size_t i = 1; i < n; ++i) {
    const double factor = step[i - 1] / diagonal[i - 1];
    diagonal[i] -= factor * step[i - 1];
    right[i] -= factor * right[i - 1];
  }
  std::vector<double> sixth(n);
  sixth[n - 1] = right[n - 1] / diagonal[n - 1];
  for (std::size_t i = n - 1; i-- > 0;) sixth[i] = (right[i] - step[i] * sixth[i + 1]) / diagonal[i];
  return sixth;
}

using Eigen::Isometry3d;
using Eigen::Vector3d;

Isometry3d moved(const Motion& motion, const std::vector<double>& values) {
  const double amount = motion.curve(motion.coordinate < 0 ? 0 : values[static_cast<std::size_t>(motion.coordinate)]);
  if (motion.kind == Motion::Kind::shift) return Isometry3d(Eigen::Translation3d(amount * motion.axis));
  return Eigen::Translation3d(motion.point) * Eigen::AngleAxisd(amount, motion.axis) *
         Eigen::Translation3d(-motion.point);
}

bool is_on(const PathPoint& point, const ModelPose& pose) {
  if (!point.condition) return true;
  const double value = pose.values[static_cast<std::size_t>(point.condition->coordinate)];
  return value >= point.condition->low && value <= point.condition->high;
}

Vector3d world_position(const PathPoint& point, const ModelPose& pose) {
  Vector3d local = point.position;
  for (std::size_t i = 0; i < point.moving.size(); ++i) {
    const PathPoint::Follow& follow = point.moving[i];
    local[static_cast<Eigen::Index>(i)] = follow.curve(pose.values[static_cast<std::size_t>(follow.coordinate)]);
  }
  return pose.segments[static_cast<std::size_t>(point.segment)] * local;
}

template <typename Named>
int find_named(const std::vector<Named>& list, const std::string& name) {
  const auto found = std::ranges::find_if(list, [&](const Named& one) { return one.name == name; });
  return found == list.end() ? -1 : static_cast<int>(found - list.begin());
}

// Bends the way from the last stop to `next` around a surface.
void add_wrap(const Wrap& wrap, const ModelPose& pose, const Vector3d& next, std::vector<PathStop>& stops) {
  const Isometry3d frame = pose.segments[static_cast<std::size_t>(wrap.segment)] * wrap.frame;
  const Isometry3d to_frame = frame.inverse();
  std::optional<Vector3d> side;
  if (wrap.side) side = to_frame * world_position(*wrap.side, pose);
  const std::optional<Arc> arc =
      wrap_around(wrap.shape, wrap.radius, side, to_frame * stops.back().position, to_frame * next);
  if (!arc) return;
  if (arc->length > 0) stops.push_back({wrap.segment, frame * arc->from, arc->length});
  stops.push_back({wrap.segment, frame * arc->to});
}

using Eigen::Vector2d;

constexpr double kTiny = 1e-15;

double cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

// The point where the tangent from p touches the circle of this radius about the origin, turning by `sign`.
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

// The direction of p; of a point at the origin, the first axis.
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

  // The better way around is nearer to the side, or without one the shorter, the second where they are as good. It is
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

// The shortest way from start to end that touches the circle leaves and meets it at the same angle alpha to the radius.
// With z = sin(alpha), the sines' law holds in the triangles (centre, end, touching point). Their angles at the centre
// are asin(z) - asin(z radius / distance), which add up to the angle between the ends.
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
  // MuJoCo's solver gives up so near to a tangent, and takes the point below the middle between the ends. Its models
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

// The plane through a sphere's centre and both ends; if these three are on a line, also through the side.
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

Curve Curve::polynomial(std::vector<double> coefficients) {
  Curve curve;
  curve.polynomial_ = std::move(coefficients);
  return curve;
}

Curve Curve::pieces(const std::vector<double>& x, const std::vector<double>& y, const std::vector<double>& sixth) {
  Curve curve;
  for (std::size_t i = 0; i + 1 < x.size(); ++i) {
    const double h = x[i + 1] - x[i];
    curve.pieces_.push_back({x[i],
                             {y[i], (y[i + 1] - y[i]) / h - h * (sixth[i + 1] + 2 * sixth[i]), 3 * sixth[i],
                              (sixth[i + 1] - sixth[i]) / h}});
  }
  const Piece& last = curve.pieces_.back();
  const double h = x.back() - last.x;
  curve.pieces_.push_back({x.back(), {y.back(), last.a[1] + h * (2 * last.a[2] + h * 3 * last.a[3]), 0, 0}});
  return curve;
}

Curve Curve::spline(const std::vector<double>& x, const std::vector<double>& y) {
  return pieces(x, y, second_derivatives(x, y));
}

Curve Curve::polyline(const std::vector<double>& x, const std::vector<double>& y) {
  return pieces(x, y, std::vector<double>(x.size(), 0.0));
}

double Curve::operator()(double x) const {
  if (pieces_.empty()) {
    double sum = 0;
    for (std::size_t k = polynomial_.size(); k-- > 0;) sum = sum * x + polynomial_[k];
    return sum;
  }
  const Piece& first = pieces_.front();
  if (x < first.x) return first.a[0] + first.a[1] * (x - first.x);
  const auto after = std::upper_bound(pieces_.begin(), pieces_.end(), x,
                                      [](double value, const Piece& piece) { return value < piece.x; });
  const Piece& piece = *(after - 1);
  const double t = x - piece.x;
  return piece.a[0] + t * (piece.a[1] + t * (piece.a[2] + t * piece.a[3]));
}

Curve Curve::scaled(double factor) const {
  Curve curve = *this;
  for (double& coefficient : curve.polynomial_) coefficient *= factor;
  for (Piece& piece : curve.pieces_) {
    for (double& coefficient : piece.a) coefficient *= factor;
  }
  return curve;
}

int Model::find_segment(const std::string& name) const { return find_named(segments, name); }
int Model::find_coordinate(const std::string& name) const { return find_named(coordinates, name); }

std::vector<double> default_values(const Model& model) {
  return transformed(model.coordinates, &Coordinate::default_value);
}

ModelPose pose_model(const Model& model, const std::vector<double>& values) {
  ModelPose pose{values, {}};
  for (const Segment& segment : model.segments) {
    Isometry3d world =
        segment.parent < 0 ? Isometry3d::Identity() : pose.segments[static_cast<std::size_t>(segment.parent)];
    world = world * segment.before;
    for (const Motion& motion : segment.motions) world = world * moved(motion, values);
    pose.segments.push_back(world * segment.after);
  }
  return pose;
}

bool honoured(const Wrap& wrap) { return wrap.shape != Wrap::Shape::other; }

std::vector<PathStop> trace_path(const ModelMuscle& muscle, const ModelPose& pose) {
  std::vector<PathStop> stops;
  for (std::size_t k = 0; k < muscle.path.size(); ++k) {
    const PathPoint& point = muscle.path[k];
    if (!is_on(point, pose)) continue;
    const Vector3d position = world_position(point, pose);
    for (const Wrap& wrap : muscle.wraps) {
      if (wrap.after + 1 == static_cast<int>(k) && honoured(wrap)) add_wrap(wrap, pose, position, stops);
    }
    stops.push_back({point.segment, position});
  }
  return stops;
}

double path_length(const std::vector<PathStop>& stops) {
  double total = 0;
  for (std::size_t k = 0; k + 1 < stops.size(); ++k) {
    total += stops[k].arc > 0 ? stops[k].arc : (stops[k + 1].position - stops[k].position).norm();
  }
  return total;
}

Model read_model(const std::string& path) {
  const std::string ending = std::filesystem::path(path).extension();
  if (ending == ".osim") return read_opensim(path);
  if (ending == ".xml") return read_mujoco(path);
  throw Error(ErrorKind::file, path, ": expected a muscle model, .osim (OpenSim) or .xml (MuJoCo), found '", ending,
              "'");
}

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

}  // namespace bodyopt::trainer::muscle_models
