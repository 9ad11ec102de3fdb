#include "trainer/muscle_models/model.h"

#include <algorithm>
#include <cstddef>
#include <filesystem>

#include "runtime/core/error.h"
#include "runtime/core/transformed.h"
#include "trainer/muscle_models/mujoco.h"
#include "trainer/muscle_models/opensim.h"
#include "trainer/muscle_models/wrap.h"

namespace bodyopt::muscle_models {
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
  const auto found = std::find_if(list.begin(), list.end(), [&](const Named& one) { return one.name == name; });
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
  throw Error(ErrorKind::file,
              path + ": expected a muscle model, .osim (OpenSim) or .xml (MuJoCo), found '" + ending + "'");
}

}  // namespace bodyopt::muscle_models
