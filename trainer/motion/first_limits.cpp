#include "trainer/motion/first_limits.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "assets/characters/joints_with_skin.h"
#include "base/linear_algebra.h"
#include "base/wording.h"
#include "runtime/core/error.h"
#include "trainer/motion/attached_rig.h"
#include "trainer/motion/held_turns.h"

namespace bodyopt::trainer {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kTurns = 2;                     // degrees: less is no motion of the joint
constexpr double kWidening = 0.1, kWiderBy = 1;  // of a range in clips; degrees
constexpr double kMost[] = {170, 90, 170};       // degrees of bend, side, twist: beyond, the three are ambiguous
constexpr double kDeviation = 0.25;              // of a joint's widest range

// Degrees either way, of joints that no clip turns.
struct Rule {
  double swing, twist;
  const char* source;
};
constexpr Rule kFork{15, 10, "rule for a joint at a fork, as of trunks and hands; no clip turns it"};
constexpr Rule kChain{30, 15, "rule for a joint in a chain, as of limbs, necks and tails; no clip turns it"};
constexpr Rule kTip{10, 5, "rule for the tip of a chain; no clip turns it"};

// Joints that move some of the skin against the rest of it. What moves all of it is a root, wherever it stands.
std::vector<std::uint32_t> bending_joints(const Character& character, const std::vector<int>& with_skin) {
  std::vector<std::uint32_t> joints = joints_that_bend(character);
  std::erase_if(joints, [&](std::uint32_t j) { return with_skin[j] == 0; });
  return joints;
}

const Rule& rule_of(const Skeleton& skeleton, const std::vector<int>& with_skin, std::size_t joint) {
  int below = 0;
  for (std::size_t j = 0; j < skeleton.size(); ++j) {
    below += with_skin[j] > 0 && skeleton.joints[j].parent == static_cast<int>(joint) ? 1 : 0;
  }
  return below == 0 ? kTip : (below == 1 ? kChain : kFork);
}

Eigen::Quaterniond quaternion(const Quat& q) { return {q[3], q[0], q[1], q[2]}; }

// The direction of the bone, or up where there is none.
Vector3d bone_of(const Skeleton& skeleton, std::size_t joint) {
  const Vec3 bone = length_of_bone(skeleton, joint);
  const Vector3d along(bone[0], bone[1], bone[2]);
  return along.norm() > 1e-9 ? along.normalized() : Vector3d::UnitY();
}

// The direction across the bone that is most nearly left-right.
Vector3d across(const Vector3d& bone) {
  const Vector3d wanted = std::abs(bone.x()) < 0.9 ? Vector3d::UnitX() : Vector3d::UnitZ();
  return (wanted - wanted.dot(bone) * bone).normalized();
}

// Axis times radians of what is left of a turn without its twist about the bone, which comes first.
Vector3d swing_of(const Quat& turn, const Vector3d& bone) {
  const Eigen::Quaterniond q = quaternion(turn);
  const Vector3d along = q.vec().dot(bone) * bone;
  const Eigen::Quaterniond twist(q.w(), along.x(), along.y(), along.z());
  if (!(twist.norm() > 1e-9))
    return Vector3d::Zero();  // half a turn about an axis across the bone has no twist to tell
  const Eigen::AngleAxisd swing(q * twist.normalized().conjugate());
  return (swing.angle() > std::numbers::pi ? swing.angle() - 2 * std::numbers::pi : swing.angle()) * swing.axis();
}

// The axis across the bone that the turns are most about: a hinge's own. One that is nearly left-right points as
// across() does. Without such turns it is across().
Vector3d bend_of(const std::vector<Quat>& turns, const Vector3d& bone) {
  Matrix3d moments = Matrix3d::Zero();
  for (const Quat& turn : turns) {
    const Vector3d swing = swing_of(turn, bone);
    moments += swing * swing.transpose();
  }
  const Vector3d usual = across(bone);
  const double radians = kTurns * std::numbers::pi / 180;
  const SymmetricEigen3 eigen = symmetric_eigen_3(moments);
  if (eigen.values[2] < radians * radians) return usual;
  const Vector3d most = eigen.vectors.col(2);
  const Vector3d bend = (most - most.dot(bone) * bone).normalized();
  return bend.dot(usual) < 0 ? Vector3d(-bend) : bend;
}

// Columns: bend, side and twist, rest space.
Matrix3d axes_of(const Vector3d& bend, const Vector3d& bone) {
  Matrix3d axes;
  axes << bend, bone.cross(bend), bone;
  return axes;
}

// The angles of the product bend * side * twist, degrees.
Vector3d angles_of(const Quat& turn, const Matrix3d& axes) {
  const Matrix3d r = axes.transpose() * quaternion(turn).toRotationMatrix() * axes;
  const Vector3d angles(std::atan2(-r(1, 2), r(2, 2)), std::asin(std::clamp(r(0, 2), -1.0, 1.0)),
                        std::atan2(-r(0, 1), r(0, 0)));
  return 180 / std::numbers::pi * angles;
}

struct Ranges {
  Vector3d low = Vector3d::Zero(), high = Vector3d::Zero();  // bend, side, twist, degrees
  bool moves() const { return (high - low).maxCoeff() >= kTurns; }
};

Ranges shown_ranges(const std::vector<Quat>& turns, const Matrix3d& axes) {
  Ranges ranges;
  for (const Quat& turn : turns) {
    const Vector3d angles = angles_of(turn, axes);
    ranges.low = ranges.low.cwiseMin(angles);
    ranges.high = ranges.high.cwiseMax(angles);
  }
  return ranges;
}

Ranges widened(Ranges ranges) {
  const Vector3d more = (kWidening * (ranges.high - ranges.low)).array() + kWiderBy;
  return {ranges.low - more, ranges.high + more};
}

Ranges ruled(const Rule& rule) {
  const Vector3d most(rule.swing, rule.swing, rule.twist);
  return {-most, most};
}

// Files are edited by hand: tenths of a degree.
double tenths(double degrees) { return std::round(10 * degrees) / 10; }

double readable(double component) { return std::round(1e6 * component) / 1e6 + 0.0; }  // no -0

// How far a degree of freedom goes, and why.
DegreeOfFreedom first_dof(const std::string& name, const JointTurn& turn, double low, double high, double most,
                          std::string source) {
  if (low < -most || high > most) {
    source += ", cut at " + rounded(most) + " degrees, beyond which the joint's three angles are ambiguous";
  }
  return {name, 0, tenths(std::max(low, -most)), tenths(std::min(high, most)), {turn}, std::move(source)};
}

void add_joint(const Skeleton& skeleton, std::uint32_t joint, const Matrix3d& axes, const Ranges& ranges,
               const std::string& source, JointLimits& limits) {
  constexpr const char* kNames[] = {" bend", " side", " twist"};
  for (Eigen::Index k = 0; k < 3; ++k) {
    const Vec3 axis{readable(axes(0, k)), readable(axes(1, k)), readable(axes(2, k))};
    limits.dofs.push_back(first_dof(skeleton.joints[joint].name + kNames[k], {joint, axis}, ranges.low[k],
                                    ranges.high[k], kMost[k], source));
  }
  const double widest = (ranges.high - ranges.low).maxCoeff();
  limits.deviations.push_back({joint, std::min(kUsualDeviation, tenths(kDeviation * widest)),
                               "a quarter of the joint's widest range, 15 degrees at most"});
}

}  // namespace

JointLimits first_limits(const Character& own, const std::vector<Pose>& own_poses) {
  const AttachedRig rig(own.skeleton, detached_joints(own));
  const Character character = rig.attached(own);
  const std::vector<Pose> poses = rig.attached(own_poses);
  const Skeleton& skeleton = character.skeleton;
  const std::vector<int> with_skin = joints_with_skin(character);
  JointLimits limits;
  limits.source =
      "first limits, to be edited: a joint's 'rest' of 0 is the bind pose; 'twist' is about its bone, 'bend' about "
      "what the clips turn it about most, or else nearly left-right, 'side' about the third";
  for (const std::uint32_t j : bending_joints(character, with_skin)) {
    const std::vector<Quat> turns = turns_from_bind(skeleton, poses, j);
    const Vector3d bone = bone_of(skeleton, j);
    const Matrix3d axes = axes_of(bend_of(turns, bone), bone);
    const Ranges shown = shown_ranges(turns, axes);
    if (shown.moves()) {
      add_joint(skeleton, j, axes, widened(shown), "what the clips turn it by, widened by a tenth and a degree",
                limits);
    } else {
      const Rule& rule = rule_of(skeleton, with_skin, j);
      add_joint(skeleton, j, axes_of(across(bone), bone), ruled(rule), rule.source, limits);
    }
  }
  if (limits.dofs.empty()) {
    throw Error(ErrorKind::mismatch, "no joint of '" + character.name +
                                         "' below the root moves some of the skin against the rest: there is nothing "
                                         "to set limits for");
  }
  return rig.detached(limits);
}

}  // namespace bodyopt::trainer
