#include "trainer/motion/held_turns.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/wording.h"
#include "geometry/nearest_rotation.h"
#include "runtime/core/transformed.h"
#include "runtime/host/rig.h"

namespace bodyopt::trainer {
namespace {

constexpr double kCoupled = 0.97;
constexpr double kLeastCoupledTurn = 3 * std::numbers::pi / 180;
constexpr double kRidge = 1e-4;  // square radians: turns about an axis that is not used tell nothing

using Turns = Eigen::MatrixX3d;  // N x 3: axis times twice the sine of half the angle

Turns turns_of(const Skeleton& skeleton, const std::vector<Pose>& poses, std::size_t joint) {
  Turns turns(static_cast<Eigen::Index>(poses.size()), 3);
  const Quat bind = conjugate(skeleton.joints[joint].bind.rotation);
  for (std::size_t k = 0; k < poses.size(); ++k) {
    const Quat q = bind * poses[k].joints[joint].rotation;
    const double sign = q[3] < 0 ? -2 : 2;
    turns.row(static_cast<Eigen::Index>(k)) << sign * q[0], sign * q[1], sign * q[2];
  }
  return turns;
}

Eigen::Matrix3d covariance(const Turns& a, const Turns& b) {
  return (a.rowwise() - a.colwise().mean()).transpose() * (b.rowwise() - b.colwise().mean()) /
         static_cast<double>(a.rows());
}

// The inverse of the Cholesky factor of the covariance and a ridge.
Eigen::Matrix3d whitening(const Turns& turns) {
  const Eigen::Matrix3d ridged = covariance(turns, turns) + kRidge * Eigen::Matrix3d::Identity();
  return ridged.llt().matrixL().solve(Eigen::Matrix3d::Identity());
}

double canonical_correlation(const Turns& a, const Turns& b) {
  const Eigen::Matrix3d between = whitening(a) * covariance(a, b) * whitening(b).transpose();
  return nearest_rotation(between).stretches[0];
}

constexpr double kLeastTurn = 25, kBeyond = 5;  // degrees
constexpr double kLeastShare = 0.95;
constexpr double kMostVariation = 0.5;  // of the turn

// One of the turns that make up a joint's rotation.
struct TurnRange {
  Vec3 axis;
  double low, high;  // radians
};

std::vector<TurnRange> turns_of(const JointLimits& limits, std::uint32_t joint) {
  std::vector<TurnRange> turns;
  for (const DegreeOfFreedom& dof : limits.dofs) {
    for (const JointTurn& turn : dof.turns) {
      if (turn.joint != joint) continue;
      const double scale = turn.share * std::numbers::pi / 180;
      const auto [low, high] = std::minmax({scale * (dof.min - dof.rest), scale * (dof.max - dof.rest)});
      turns.push_back({turn.axis, low, high});
    }
  }
  return turns;
}

// The angle in a turn's range that comes nearest to a rotation, the other turns being as they are. It makes |cos((angle
// - best) / 2)| largest.
double nearest_angle(const Quat& wanted, const TurnRange& turn) {
  const double along = wanted[0] * turn.axis[0] + wanted[1] * turn.axis[1] + wanted[2] * turn.axis[2];
  const double best = 2 * std::atan2(along, wanted[3]), whole = 2 * std::numbers::pi;
  double nearest = turn.low, cosine = -1;
  for (const double angle : {best, best - whole, best + whole, turn.low, turn.high}) {
    const double within = std::clamp(angle, turn.low, turn.high);
    const double here = std::abs(std::cos((within - best) / 2));
    if (here > cosine + 1e-12) {
      cosine = here;
      nearest = within;
    }
  }
  return nearest;
}

Quat product(const std::vector<TurnRange>& turns, const std::vector<double>& angles, std::size_t begin,
             std::size_t end) {
  Quat q{0, 0, 0, 1};
  for (std::size_t k = begin; k < end; ++k) q = q * axis_angle(turns[k].axis, angles[k]);
  return q;
}

// The turn from the nearest rotation within the ranges to `wanted`, before the other turns. `angles`: where to begin,
// and the nearest. One angle after the other is made the best it can be, which never makes it worse.
Quat beyond(const std::vector<TurnRange>& turns, const Quat& wanted, std::vector<double>& angles) {
  constexpr int kMostRounds = 60;
  constexpr double kSettled = 1e-6;  // radians
  for (int round = 0; round < kMostRounds; ++round) {
    double step = 0;
    for (std::size_t k = 0; k < turns.size(); ++k) {
      const Quat left =
          conjugate(product(turns, angles, 0, k)) * wanted * conjugate(product(turns, angles, k + 1, turns.size()));
      const double angle = nearest_angle(left, turns[k]);
      step = std::max(step, std::abs(angle - angles[k]));
      angles[k] = angle;
    }
    if (step < kSettled) break;
  }
  return normalized(conjugate(product(turns, angles, 0, turns.size())) * wanted);
}

// Axis times degrees, at most half a turn.
Vec3 rotation_vector(const Quat& q) {
  const double sine = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2]);
  const double scale = sine > 0 ? std::copysign(angle_of(q) / sine, q[3]) : 0;
  return {scale * q[0], scale * q[1], scale * q[2]};
}

// How far a joint is beyond its limits in every pose. Begins where the frame before ended and, where that leaves
// something, at rest, too: the nearest rotation may be found from one of them only. A turn of more than half a circle
// may follow one of less. A joint held at about that does not seem to go to and fro then.
std::vector<Vec3> turns_beyond(const std::vector<TurnRange>& turns, const std::vector<Quat>& rotations) {
  const std::vector<double> rest(turns.size(), 0);
  std::vector<double> angles = rest;
  std::vector<Vec3> result;
  for (const Quat& rotation : rotations) {
    Quat found = beyond(turns, rotation, angles);
    if (angle_of(found) > kBeyond) {
      std::vector<double> from_rest = rest;
      const Quat other = beyond(turns, rotation, from_rest);
      if (angle_of(other) < angle_of(found)) {
        found = other;
        angles = from_rest;
      }
    }
    Vec3 turn = rotation_vector(found);
    if (!result.empty() && length(turn) > 90 && dot(turn, result.back()) < 0) turn = (1 - 360 / length(turn)) * turn;
    result.push_back(turn);
  }
  return result;
}

std::string describe_axis(const HeldTurn& turn, const Skeleton& skeleton) {
  const Vec3 bone = length_of_bone(skeleton, turn.joint);
  constexpr double kAlong = 0.9;
  if (std::abs(dot(bone, turn.axis)) > kAlong * length(bone)) return "about its length";
  const Vec3 size{std::abs(turn.axis[0]), std::abs(turn.axis[1]), std::abs(turn.axis[2])};
  const auto largest = std::max_element(size.begin(), size.end()) - size.begin();
  constexpr const char* kAxes[] = {"left-right", "vertical", "front-back"};
  return std::string("about the ") + kAxes[largest] + " axis";
}

}  // namespace

Angles rest_angles(const JointLimits& limits) {
  Angles angles;
  for (const DegreeOfFreedom& dof : limits.dofs) angles.push_back(dof.rest);
  return angles;
}

std::vector<Quat> joint_turns(std::size_t joint_count, const JointLimits& limits, const Posture& posture) {
  std::vector<Quat> turns(joint_count, Quat{0, 0, 0, 1});
  for (std::size_t k = 0; k < limits.dofs.size(); ++k) {
    const double away = (posture.angles[k] - limits.dofs[k].rest) * std::numbers::pi / 180;
    for (const JointTurn& turn : limits.dofs[k].turns) {
      turns[turn.joint] = turns[turn.joint] * axis_angle(turn.axis, turn.share * away);
    }
  }
  for (std::size_t j = 0; j < posture.deviations.size(); ++j) {
    const double degrees = length(posture.deviations[j]);
    if (!(degrees > 0)) continue;
    turns[j] = axis_angle((1 / degrees) * posture.deviations[j], degrees * std::numbers::pi / 180) * turns[j];
  }
  return turns;
}

Pose limited_pose(const Skeleton& skeleton, const JointLimits& limits, const Posture& posture) {
  const std::vector<Quat> turns = joint_turns(skeleton.size(), limits, posture), world = bind_rotations(skeleton);
  Pose pose = bind_pose(skeleton);
  for (std::size_t j = 0; j < skeleton.size(); ++j) {
    Quat& own = pose.joints[j].rotation;
    own = normalized(own * (conjugate(world[j]) * turns[j] * world[j]));
  }
  return pose;
}

double angle_of(const Quat& q) { return angle_between({0, 0, 0, 1}, q) * 180 / std::numbers::pi; }

double largest_change(const Angles& from, const Angles& to) {
  double largest = 0;
  for (std::size_t k = 0; k < from.size(); ++k) largest = std::max(largest, std::abs(to[k] - from[k]));
  return largest;
}

double largest_change(const Posture& from, const Posture& to) {
  double largest = largest_change(from.angles, to.angles);
  const auto deviation = [](const Posture& posture, std::size_t j) {
    return j < posture.deviations.size() ? posture.deviations[j] : Vec3{};
  };
  for (std::size_t j = 0; j < std::max(from.deviations.size(), to.deviations.size()); ++j) {
    largest = std::max(largest, length(deviation(to, j) - deviation(from, j)));
  }
  return largest;
}

std::size_t steps_between(const Angles& from, const Angles& to, double step) {
  return static_cast<std::size_t>(std::ceil(largest_change(from, to) / step - 1e-9));
}

void walk(const Angles& from, const Angles& to, double step, std::vector<Angles>& frames) {
  const std::size_t steps = steps_between(from, to, step);
  for (std::size_t s = 1; s < steps; ++s) {
    const double t = static_cast<double>(s) / static_cast<double>(steps);
    Angles between(from.size());
    for (std::size_t k = 0; k < from.size(); ++k) between[k] = from[k] + t * (to[k] - from[k]);
    frames.push_back(between);
  }
  if (steps > 0) frames.push_back(to);
}

std::vector<CoupledJoints> coupled_joints(const Skeleton& skeleton, const std::vector<Pose>& poses) {
  std::vector<CoupledJoints> coupled;
  if (poses.empty()) return coupled;
  const auto turns_enough = [&](const Turns& turns) {
    return turns.squaredNorm() > kLeastCoupledTurn * kLeastCoupledTurn * static_cast<double>(poses.size());
  };
  for (std::uint32_t j = 0; j < skeleton.size(); ++j) {
    const int above = skeleton.joints[j].parent;
    if (above < 0 || skeleton.joints[static_cast<std::size_t>(above)].parent < 0) continue;
    const auto parent = static_cast<std::uint32_t>(above);
    const Turns own = turns_of(skeleton, poses, j), others = turns_of(skeleton, poses, parent);
    if (!turns_enough(own) || !turns_enough(others)) continue;
    const double correlation = canonical_correlation(own, others);
    if (correlation > kCoupled) coupled.push_back({j, parent, correlation});
  }
  return coupled;
}

std::string describe(const std::vector<CoupledJoints>& coupled, const Skeleton& skeleton) {
  if (coupled.empty()) return "";
  std::vector<std::string> pairs;
  for (const CoupledJoints& pair : coupled) {
    pairs.push_back(skeleton.joints[pair.joint].name + "' with '" + skeleton.joints[pair.parent].name);
  }
  return "these joints turn only together, so that nobody can learn what each of them moves: " + list_names(pairs, 6) +
         "; poses that turn one without the other would tell ('deviations' in limits.json)";
}

std::vector<HeldTurn> held_turns(const JointLimits& limits, const Skeleton& skeleton, const std::vector<Pose>& poses) {
  std::vector<HeldTurn> held;
  if (poses.empty()) return held;
  const auto count = static_cast<double>(poses.size());
  for (std::uint32_t j = 0; j < skeleton.size(); ++j) {
    const std::vector<TurnRange> turns = turns_of(limits, j);
    if (turns.empty()) continue;
    const std::vector<Vec3> excess = turns_beyond(turns, turns_from_bind(skeleton, poses, j));
    Vec3 mean{0, 0, 0};
    double variance = 0;
    for (const Vec3& turn : excess) mean = mean + (1 / count) * turn;
    for (const Vec3& turn : excess) variance += dot(turn - mean, turn - mean) / count;
    const auto frames =
        std::count_if(excess.begin(), excess.end(), [](const Vec3& turn) { return length(turn) > kBeyond; });
    const double degrees = length(mean), share = static_cast<double>(frames) / count;
    if (degrees < kLeastTurn || share < kLeastShare || std::sqrt(variance) > kMostVariation * degrees) continue;
    const double sign = degrees > 180 ? -1 : 1;
    held.push_back({j, (sign / degrees) * mean, std::min(degrees, 360 - degrees), share});
  }
  return held;
}

std::string describe(const HeldTurn& turn, const Skeleton& skeleton, std::size_t frames) {
  const long percent = std::lround(100 * turn.share);
  const std::string when =
      frames == 1 ? "in the only frame"
                  : (percent == 100 ? "in every frame" : "in " + std::to_string(percent) + " % of the frames");
  return "'" + skeleton.joints[turn.joint].name + "' is turned by " + std::to_string(std::lround(turn.degrees)) +
         " degrees " + describe_axis(turn, skeleton) + " beyond its limits " + when +
         ": was the clip made for another rest pose?";
}

std::vector<std::string> turning_without_limits(const JointLimits& limits, const Skeleton& skeleton,
                                                const std::vector<Pose>& poses) {
  constexpr double kTurns = 1;  // degrees
  std::vector<std::string> names;
  for (std::uint32_t j = 0; j < skeleton.size(); ++j) {
    if (skeleton.joints[j].parent < 0 || !turns_of(limits, j).empty()) continue;
    const std::vector<Quat> turns = turns_from_bind(skeleton, poses, j);
    if (std::any_of(turns.begin(), turns.end(), [](const Quat& q) { return angle_of(q) > kTurns; })) {
      names.push_back(skeleton.joints[j].name);
    }
  }
  return names;
}

std::vector<Quat> turns_from_bind(const Skeleton& skeleton, const std::vector<Pose>& poses, std::size_t joint) {
  const Quat world = bind_rotations(skeleton)[joint];
  const Quat to_bind = world * conjugate(normalized(skeleton.joints[joint].bind.rotation));
  return transformed(poses, [&](const Pose& pose) {
    return normalized(to_bind * normalized(pose.joints[joint].rotation) * conjugate(world));
  });
}

Vec3 length_of_bone(const Skeleton& skeleton, std::size_t joint) {
  const std::vector<Affine> bind = posed_joints(skeleton, bind_pose(skeleton).joints);
  const auto at = [&](std::size_t j) { return bind[j] * Vec3{0, 0, 0}; };
  Vec3 sum{0, 0, 0};
  double count = 0;
  for (std::size_t j = 0; j < skeleton.size(); ++j) {
    if (skeleton.joints[j].parent != static_cast<int>(joint)) continue;
    sum = sum + (at(j) - at(joint));
    ++count;
  }
  return (count > 0 ? 1 / count : 0) * sum;
}

}  // namespace bodyopt::trainer
