#include "trainer/motion/first_limits.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "runtime/core/error.h"
#include "trainer/motion/turns_from_bind.h"

namespace bodyopt {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kTurns = 2;                     // degrees: less is no motion of the joint
constexpr double kWidening = 0.1, kWiderBy = 1;  // of a range in clips; degrees
constexpr double kLargest = 170;                 // degrees: beyond, angles about three axes are ambiguous
constexpr double kDeviation = 0.25;              // of a joint's widest range
constexpr double kSharesSkin = 0.05;             // of a vertex: less is a trace

// Degrees either way, of joints that no clip turns.
struct Rule {
  double swing, twist;
  const char* source;
};
constexpr Rule kFork{15, 10, "rule for a joint at a fork, as of trunks and hands; no clip turns it"};
constexpr Rule kChain{30, 15, "rule for a joint in a chain, as of limbs, necks and tails; no clip turns it"};
constexpr Rule kTip{10, 5, "rule for the tip of a chain; no clip turns it"};

// Of every joint, whether skin follows it or a joint below it.
std::vector<char> joints_with_skin(const Character& character) {
  const Skeleton& skeleton = character.skeleton;
  std::vector<char> with_skin(skeleton.size(), false);
  for (const auto& weights : character.weights) {
    for (const JointWeight& weight : weights) with_skin[weight.joint] |= weight.weight > kSharesSkin;
  }
  for (std::size_t j = skeleton.size(); j-- > 0;) {
    const int parent = skeleton.joints[j].parent;
    if (parent >= 0) with_skin[static_cast<std::size_t>(parent)] |= with_skin[j];
  }
  return with_skin;
}

const Rule& rule_of(const Skeleton& skeleton, const std::vector<char>& with_skin, std::size_t joint) {
  int below = 0;
  for (std::size_t j = 0; j < skeleton.size(); ++j) {
    below += with_skin[j] && skeleton.joints[j].parent == static_cast<int>(joint) ? 1 : 0;
  }
  return below == 0 ? kTip : (below == 1 ? kChain : kFork);
}

// Columns: bend, side and twist; the last along the bone, or up where there is none, the first as nearly left-right as
// can be.
Matrix3d axes_of(const Skeleton& skeleton, std::size_t joint) {
  const Vec3 bone = length_of_bone(skeleton, joint);
  Vector3d twist(bone[0], bone[1], bone[2]);
  twist = twist.norm() > 1e-9 ? twist.normalized() : Vector3d::UnitY();
  const Vector3d across = std::abs(twist.x()) < 0.9 ? Vector3d::UnitX() : Vector3d::UnitZ();
  const Vector3d bend = (across - across.dot(twist) * twist).normalized();
  Matrix3d axes;
  axes << bend, twist.cross(bend), twist;
  return axes;
}

// The angles of the product bend * side * twist, degrees.
Vector3d angles_of(const Quat& turn, const Matrix3d& axes) {
  const Matrix3d r =
      axes.transpose() * Eigen::Quaterniond(turn[3], turn[0], turn[1], turn[2]).toRotationMatrix() * axes;
  const Vector3d angles(std::atan2(-r(1, 2), r(2, 2)), std::asin(std::clamp(r(0, 2), -1.0, 1.0)),
                        std::atan2(-r(0, 1), r(0, 0)));
  return 180 / std::numbers::pi * angles;
}

struct Ranges {
  Vector3d low = Vector3d::Zero(), high = Vector3d::Zero();  // bend, side, twist, degrees
  bool moves() const { return (high - low).maxCoeff() >= kTurns; }
};

Ranges shown_ranges(const Skeleton& skeleton, const std::vector<Pose>& poses, std::size_t joint, const Matrix3d& axes) {
  Ranges ranges;
  for (const Quat& turn : turns_from_bind(skeleton, poses, joint)) {
    const Vector3d angles = angles_of(turn, axes);
    ranges.low = ranges.low.cwiseMin(angles);
    ranges.high = ranges.high.cwiseMax(angles);
  }
  return ranges;
}

Ranges widened(Ranges ranges) {
  const Vector3d more = (kWidening * (ranges.high - ranges.low)).array() + kWiderBy;
  ranges.low = (ranges.low - more).cwiseMax(-kLargest);
  ranges.high = (ranges.high + more).cwiseMin(kLargest);
  return ranges;
}

Ranges ruled(const Rule& rule) {
  const Vector3d most(rule.swing, rule.swing, rule.twist);
  return {-most, most};
}

// Files are edited by hand: tenths of a degree.
double tenths(double degrees) { return std::round(10 * degrees) / 10; }

double readable(double component) { return std::round(1e6 * component) / 1e6 + 0.0; }  // no -0

void add_joint(const Skeleton& skeleton, std::uint32_t joint, const Matrix3d& axes, const Ranges& ranges,
               const std::string& source, JointLimits& limits) {
  constexpr const char* kNames[] = {" bend", " side", " twist"};
  for (Eigen::Index k = 0; k < 3; ++k) {
    const Vec3 axis{readable(axes(0, k)), readable(axes(1, k)), readable(axes(2, k))};
    limits.dofs.push_back({skeleton.joints[joint].name + kNames[k],
                           0,
                           tenths(ranges.low[k]),
                           tenths(ranges.high[k]),
                           {{joint, axis}},
                           source});
  }
  const double widest = (ranges.high - ranges.low).maxCoeff();
  limits.deviations.push_back({joint, std::min(kUsualDeviation, tenths(kDeviation * widest))});
}

}  // namespace

JointLimits first_limits(const Character& character, const std::vector<Pose>& poses) {
  const Skeleton& skeleton = character.skeleton;
  const std::vector<char> with_skin = joints_with_skin(character);
  JointLimits limits;
  for (std::uint32_t j = 0; j < skeleton.size(); ++j) {
    if (skeleton.joints[j].parent < 0 || !with_skin[j]) continue;
    const Matrix3d axes = axes_of(skeleton, j);
    const Ranges shown = shown_ranges(skeleton, poses, j, axes);
    const Rule& rule = rule_of(skeleton, with_skin, j);
    if (shown.moves()) {
      add_joint(skeleton, j, axes, widened(shown), "what the clips turn it by, widened by a tenth and a degree",
                limits);
    } else {
      add_joint(skeleton, j, axes, ruled(rule), rule.source, limits);
    }
  }
  if (limits.dofs.empty()) {
    throw Error(ErrorKind::mismatch, "no joint of '" + character.name +
                                         "' below the root moves any skin: there is nothing to set limits for");
  }
  return limits;
}

}  // namespace bodyopt
