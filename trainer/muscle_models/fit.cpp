#include "trainer/muscle_models/fit.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <tuple>

#include "base/linear_algebra.h"
#include "geometry/nearest_rotation.h"
#include "geometry/thickness.h"
#include "runtime/core/error.h"

namespace bodyopt::trainer::muscle_models {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Newtons per square metre of physiological cross-section: 60 N/cm2, from which many models have their forces. It is
// the value of Rajagopal et al. 2016 (IEEE Transactions on Biomedical Engineering 63).
constexpr double kSpecificTension = 6e5;
constexpr double kTendonDepth = 0.004;     // metres under the skin, at least
constexpr double kBellyDepth = 0.8;        // of the belly's radius at the point, at least
constexpr double kSmallestRadius = 0.003;  // metres
constexpr double kLongWay = 0.05;          // metres between two points of a path
constexpr int kHalvings = 2;               // of a long way
constexpr double kShortest = 1e-3;         // metres

[[noreturn]] void mismatch(const auto&... what) { throw Error(ErrorKind::mismatch, what...); }

// The share of the radius at u from origin (0) to insertion (1): the simulation's bellies have the same shape.
double belly_profile(double u) { return std::sqrt(std::max(std::sin(std::numbers::pi * u), 0.0)); }

struct FittedSegment {
  Alignment alignment;  // model world, default pose, to character
  int joint = -1;       // -1: the mapping does not name the segment
};

// One side of the body: the model as it is, or mirrored.
class SideFit {
 public:
  SideFit(const Model& model, const Mapping& mapping, const Character& character, const SkinDepth& skin, bool mirrored)
      : model_(model),
        mapping_(mapping),
        character_(character),
        skin_(skin),
        mirrored_(mirrored),
        pose_(pose_model(model, default_values(model))),
        segments_(model.segments.size()) {
    if (mirrored) {
      const Vector3d lateral = mapping.model_axes.col(2);
      mirror_ -= 2 * lateral * lateral.transpose();
    }
    for (const SegmentMap& map : mapping.segments) fit_segments(map);
  }

  FittedMuscle fit(const ModelMuscle& muscle) const {
    FittedMuscle fitted;
    fitted.muscle.name = muscle.name;
    if (!mapping_.mirror_joints.empty()) fitted.muscle.name += mapping_.mirror_muscles[mirrored_ ? 1 : 0];
    if (!(muscle.max_force > 0)) mismatch(model_.file, ": the muscle '", muscle.name, "' has no largest force");
    const std::vector<PathStop> stops = trace_path(muscle, pose_);
    if (!(path_length(stops) > kShortest)) {
      mismatch(model_.file, ": the muscle '", muscle.name, "' has a path without length in the default pose");
    }
    std::vector<Vector3d> points;
    std::vector<int> joints;
    double log_scale = 0;
    for (const PathStop& stop : stops) {
      const FittedSegment& segment = segments_[static_cast<std::size_t>(stop.segment)];
      if (segment.joint < 0) {
        mismatch(mapping_.file, ": does not map the segment '",
                 model_.segments[static_cast<std::size_t>(stop.segment)].name, "', to which the muscle '", muscle.name,
                 "' of ", model_.file, " is bound: map it, or leave the muscle out");
      }
      points.push_back(segment.alignment.map * (mirror_ * stop.position));
      joints.push_back(segment.joint);
      log_scale += std::log(segment.alignment.scale) / static_cast<double>(stops.size());
    }
    fitted.full_radius = std::exp(log_scale) * std::sqrt(muscle.max_force / kSpecificTension / std::numbers::pi);
    push_under_skin(points, joints, fitted);
    fitted.muscle.radius = fitting_radius(points, fitted.full_radius);
    for (std::size_t k = 0; k < points.size(); ++k) {
      fitted.muscle.path.push_back(
          {static_cast<std::uint32_t>(joints[k]), {points[k].x(), points[k].y(), points[k].z()}});
    }
    return fitted;
  }

 private:
  int find_joint(const std::string& name) const {
    const std::string wanted = mirrored_ ? mapping_.mirrored_joint(name) : name;
    const int joint = character_.skeleton.find(wanted);
    if (joint < 0) {
      mismatch(mapping_.file, ": names the joint '", wanted, "', which the character '", character_.name,
               "' does not have");
    }
    return joint;
  }

  int find_segment(const std::string& name) const {
    const int segment = model_.find_segment(name);
    if (segment < 0) {
      mismatch(mapping_.file, ": names the segment '", name, "', which ", model_.file, " does not have");
    }
    return segment;
  }

  // The rotation of the nearest segment towards the ground that is fitted already, or that of the axes.
  Matrix3d open_turn(int segment) const {
    for (; segment >= 0; segment = model_.segments[static_cast<std::size_t>(segment)].parent) {
      const FittedSegment& fitted = segments_[static_cast<std::size_t>(segment)];
      if (fitted.joint >= 0) return fitted.alignment.turn;
    }
    return mapping_.character_axes * mapping_.model_axes.transpose();
  }

  // The first two centres must be apart, in the model and in the character.
  void require_apart(const SegmentMap& map, const std::vector<Vector3d>& from, const std::vector<Vector3d>& to) const {
    const auto refuse = [&](const std::string& first, const std::string& second) {
      mismatch(mapping_.file, ": the first two centres of '", map.segments[0], "' are at the same place: ", first,
               " and ", second, " are less than 1 mm apart; name two that are apart, first of its centres");
    };
    const auto& [first, second] = std::tie(map.centres[0], map.centres[1]);
    if (!((from[1] - from[0]).norm() > kNearestCentres)) {
      refuse("the segments '" + first[0] + "'", "'" + second[0] + "' of " + model_.file);
    }
    if (!((to[1] - to[0]).norm() > kNearestCentres)) {
      const auto name = [&](const NamePair& centre) {
        return character_.skeleton.joints[static_cast<std::size_t>(find_joint(centre[1]))].name;
      };
      refuse("the joints '" + name(first) + "'", "'" + name(second) + "' of the character '" + character_.name + "'");
    }
  }

  void fit_segments(const SegmentMap& map) {
    std::vector<Vector3d> from, to;
    for (const auto& [segment_name, joint_name] : map.centres) {
      const auto segment = static_cast<std::size_t>(find_segment(segment_name));
      from.push_back(mirror_ * (pose_.segments[segment] * model_.segments[segment].centre));
      const auto joint = static_cast<std::size_t>(find_joint(joint_name));
      to.emplace_back(bind_place(character_.skeleton, joint).data());
    }
    require_apart(map, from, to);
    FittedSegment fitted{align(from, to, open_turn(find_segment(map.segments[0]))), find_joint(map.joint)};
    for (const std::string& name : map.segments) {
      FittedSegment& segment = segments_[static_cast<std::size_t>(find_segment(name))];
      if (segment.joint >= 0) mismatch(mapping_.file, ": maps the segment '", name, "' twice");
      segment = fitted;
    }
  }

  // 0 at the first point to 1 at the last, by length.
  static std::vector<double> places(const std::vector<Vector3d>& points) {
    std::vector<double> u{0};
    for (std::size_t k = 1; k < points.size(); ++k) u.push_back(u.back() + (points[k] - points[k - 1]).norm());
    for (double& place : u) place /= u.back();
    return u;
  }

  // Tendons just under the skin, bellies deeper. Long straight ways get points between, where they come too near the
  // skin: these move with the joint of the point before.
  void push_under_skin(std::vector<Vector3d>& points, std::vector<int>& joints, FittedMuscle& fitted) const {
    for (int halvings = 0;; ++halvings) {
      const std::vector<double> u = places(points);
      for (std::size_t k = 0; k < points.size(); ++k) {
        const Vector3d tucked = tuck(points[k], wanted_depth(u[k], fitted.full_radius), fitted.muscle.name);
        fitted.largest_push = std::max(fitted.largest_push, (tucked - points[k]).norm());
        points[k] = tucked;
      }
      if (halvings == kHalvings) return;
      for (std::size_t k = points.size() - 1; k > 0; --k) {
        const Vector3d middle = 0.5 * (points[k - 1] + points[k]);
        const bool is_long = (points[k] - points[k - 1]).norm() > kLongWay;
        if (!is_long || skin_(middle) >= wanted_depth(0.5 * (u[k - 1] + u[k]), fitted.full_radius)) continue;
        points.insert(points.begin() + static_cast<std::ptrdiff_t>(k), middle);
        joints.insert(joints.begin() + static_cast<std::ptrdiff_t>(k), joints[k - 1]);
      }
    }
  }

  static double wanted_depth(double u, double full_radius) {
    return std::max(kTendonDepth, kBellyDepth * full_radius * belly_profile(u));
  }

  Vector3d tuck(const Vector3d& point, double depth, const std::string& muscle) const {
    const std::optional<Vector3d> tucked = skin_.tuck(point, depth);
    if (!tucked) {
      mismatch(mapping_.file, ": carries a point of the muscle '", muscle,
               "' outside the skin, and no place inside is near: do its centres belong to these joints?");
    }
    return *tucked;
  }

  // The largest radius, up to the full one, with which the middle third of the belly stays inside the skin.
  double fitting_radius(const std::vector<Vector3d>& points, double full_radius) const {
    const std::vector<double> u = places(points);
    double radius = full_radius;
    for (const double at : {1.0 / 3, 5.0 / 12, 0.5, 7.0 / 12, 2.0 / 3}) {
      const auto after = static_cast<std::size_t>(std::upper_bound(u.begin() + 1, u.end() - 1, at) - u.begin());
      const double t = (at - u[after - 1]) / std::max(u[after] - u[after - 1], 1e-12);
      const Vector3d point = (1 - t) * points[after - 1] + t * points[after];
      radius = std::min(radius, skin_(point) / belly_profile(at));
    }
    return std::max(radius, std::min(kSmallestRadius, full_radius));
  }

  const Model& model_;
  const Mapping& mapping_;
  const Character& character_;
  const SkinDepth& skin_;
  bool mirrored_;
  ModelPose pose_;
  std::vector<FittedSegment> segments_;
  Matrix3d mirror_ = Matrix3d::Identity();
};

// Directions in which the points spread less than this part of their largest spread are left to the similarity.
constexpr double kThin = 0.1;

// 3 x n: the points relative to their mean.
Eigen::Matrix3Xd centred(const std::vector<Vector3d>& points, Vector3d& mean) {
  Eigen::Matrix3Xd matrix(3, points.size());
  for (std::size_t k = 0; k < points.size(); ++k) matrix.col(static_cast<Eigen::Index>(k)) = points[k];
  mean = matrix.rowwise().mean();
  return matrix.colwise() - mean;
}

}  // namespace

std::vector<FittedMuscle> fit_muscles(const Model& model, const Mapping& mapping, const Character& character) {
  std::set<std::string> leave_out(mapping.leave_out.begin(), mapping.leave_out.end());
  const SkinDepth skin(character.vertices, character.triangles);
  std::vector<FittedMuscle> fitted;
  for (const bool mirrored : {false, true}) {
    if (mirrored && mapping.mirror_joints.empty()) break;
    const SideFit side(model, mapping, character, skin, mirrored);
    for (const ModelMuscle& muscle : model.muscles) {
      if (!leave_out.contains(muscle.name)) fitted.push_back(side.fit(muscle));
    }
  }
  for (const ModelMuscle& muscle : model.muscles) leave_out.erase(muscle.name);
  if (!leave_out.empty()) {
    mismatch(mapping.file, ": leaves out the muscle '", *leave_out.begin(), "', which ", model.file, " does not have");
  }
  return fitted;
}

Alignment align(const std::vector<Vector3d>& from, const std::vector<Vector3d>& to, const Matrix3d& turn) {
  Vector3d from_mean, to_mean;
  const Eigen::Matrix3Xd a = centred(from, from_mean), b = centred(to, to_mean);
  const Vector3d from_line = from[1] - from[0], to_line = to[1] - to[0];
  // The least turn from the given one that takes the first line to its image decides what the points leave open.
  const Matrix3d open = least_turn(turn * from_line, to_line).toRotationMatrix() * turn;
  Alignment result;
  result.turn = nearest_rotation(b * a.transpose() + 1e-3 * a.norm() * b.norm() * open).rotation;
  const Matrix3d similarity = b.norm() / a.norm() * result.turn;

  const SymmetricEigen3 spread = symmetric_eigen_3(a * a.transpose());
  Vector3d inverse = spread.values;  // of squared spreads
  for (double& value : inverse) value = value > kThin * kThin * spread.values[2] ? 1 / value : 0;
  const Eigen::Matrix<double, Eigen::Dynamic, 3> pseudo_inverse =
      a.transpose() * spread.vectors * inverse.asDiagonal() * spread.vectors.transpose();
  const Matrix3d linear = similarity + (b - similarity * a) * pseudo_inverse;
  result.scale = std::cbrt(std::abs(linear.determinant()));
  result.map.linear() = linear;
  result.map.translation() = to_mean - linear * from_mean;
  return result;
}

}  // namespace bodyopt::trainer::muscle_models
