#include "trainer/muscle_models/model.h"

#include <algorithm>
#include <filesystem>

#include "runtime/core/error.h"
#include "runtime/core/transformed.h"
#include "trainer/muscle_models/mujoco.h"
#include "trainer/muscle_models/opensim.h"
#include "trainer/muscle_models/wrap.h"

namespace bodyopt::muscle_models {
namespace {

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
