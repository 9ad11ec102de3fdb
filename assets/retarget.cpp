#include "assets/retarget.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "assets/axis_turns.h"
#include "assets/wording.h"
#include "geometry/nearest_rotation.h"
#include "runtime/core/transformed.h"
#include "runtime/host/rig.h"

namespace bodyopt {
namespace {

double cosine(const Vec3& a, const Vec3& b) {
  const double size = length(a) * length(b);
  return size > 0 ? dot(a, b) / size : 1;
}

// The smallest turn of a coordinate axis that makes it y.
Quat raise(const Vec3& up) {
  const double quarter = std::numbers::pi / 2;
  if (up[1] < -0.5) return axis_angle({1, 0, 0}, 2 * quarter);
  const Vec3 axis = cross(up, {0, 1, 0});
  return length(axis) < 0.5 ? Quat{0, 0, 0, 1} : axis_angle(axis, quarter);
}

double angle_between_bones(const Vec3& a, const Vec3& b) { return std::acos(std::clamp(cosine(a, b), -1.0, 1.0)); }

// The rotation that lays the bones `from` best along `to` (Kabsch); of many such, the smallest.
Quat fit_rotation(const std::vector<Vec3>& from, const std::vector<Vec3>& to) {
  const auto eigen = [](const Vec3& v) { return Eigen::Vector3d(v[0], v[1], v[2]); };
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (std::size_t k = 0; k < from.size(); ++k) sum += eigen(to[k]).normalized() * eigen(from[k]).transpose();
  // The identity decides what the bones leave open: one bone says nothing of the twist around it.
  constexpr double kPreferNone = 1e-6;
  sum += kPreferNone * sum.norm() * Eigen::Matrix3d::Identity();
  const Eigen::Quaterniond q(nearest_rotation(sum).rotation);
  return {q.x(), q.y(), q.z(), q.w()};
}

std::vector<Quat> source_rotations(const std::vector<SourceJoint>& joints, const std::vector<JointTransform>& locals) {
  std::vector<Quat> world;
  for (std::size_t b = 0; b < joints.size(); ++b) {
    const int parent = joints[b].joint.parent;
    world.push_back(parent < 0 ? locals[b].rotation
                               : normalized(world[static_cast<std::size_t>(parent)] * locals[b].rotation));
  }
  return world;
}

std::vector<Affine> source_transforms(const std::vector<SourceJoint>& joints,
                                      const std::vector<JointTransform>& locals) {
  std::vector<Affine> world;
  for (std::size_t b = 0; b < joints.size(); ++b) {
    const int parent = joints[b].joint.parent;
    const Affine own = affine_from(locals[b]);
    world.push_back(parent < 0 ? own : world[static_cast<std::size_t>(parent)] * own);
  }
  return world;
}

Vec3 origin_of(const Affine& a) { return {a.m[0][3], a.m[1][3], a.m[2][3]}; }

bool is_middle_of_trunk(const JointRole& role) {
  return role.part == BodyPart::hips || role.part == BodyPart::spine || role.part == BodyPart::neck ||
         role.part == BodyPart::head;
}

bool is_of_trunk(const JointRole& role) {
  return is_middle_of_trunk(role) || role.part == BodyPart::hip_joint || role.part == BodyPart::clavicle;
}

}  // namespace

Retarget::Retarget(const SourceMotion& motion, const Skeleton& skeleton, std::vector<int> match, std::size_t frames,
                   double fps, std::vector<std::string>& notes)
    : motion_(motion), skeleton_(skeleton), match_(std::move(match)), alignment_(skeleton.size(), Quat{0, 0, 0, 1}) {
  const std::vector<JointTransform> rest = transformed(motion.joints, &SourceJoint::rest);
  rest_ = source_transforms(motion.joints, rest);
  rest_rotation_ = source_rotations(motion.joints, rest);
  for (const Joint& joint : skeleton.joints) {
    const auto above = static_cast<std::size_t>(std::max(joint.parent, 0));
    below_match_.push_back(joint.parent >= 0 && (match_[above] >= 0 || below_match_[above]));
  }
  for (const SourceJoint& joint : motion.joints) {
    const int above = joint.joint.parent;
    travels_.push_back(joint.has_travel || (above >= 0 && travels_[static_cast<std::size_t>(above)]));
  }
  const Quat upright = motion.in_world ? Quat{0, 0, 0, 1} : turn_upright(skeleton);
  stand(upright);
  const Quat fitted = fit_turn();
  if (!motion.in_world) turn_ = raise(rotate(conjugate(fitted), {0, 1, 0}));
  stand(turn_ * conjugate(fitted) * upright);
  align_rests(turning_joints(frames, fps), notes);
}

// Turns the bind pose as a whole.
void Retarget::stand(const Quat& turn) {
  base_ = bind_pose(skeleton_);
  bind_rotation_ = bind_rotations(skeleton_);
  for (std::size_t j = 0; j < skeleton_.size(); ++j) {
    bind_rotation_[j] = turn * bind_rotation_[j];
    if (skeleton_.joints[j].parent >= 0) continue;
    base_.joints[j].translation = rotate(turn, base_.joints[j].translation);
    base_.joints[j].rotation = turn * base_.joints[j].rotation;
  }
  bind_ = posed_joints(skeleton_, base_.joints);
  pairs_ = bone_pairs();
}

std::vector<Retarget::BonePair> Retarget::bone_pairs() const {
  std::vector<int> matched_above(skeleton_.size(), -1);
  std::vector<BonePair> pairs;
  for (std::size_t j = 0; j < skeleton_.size(); ++j) {
    if (skeleton_.joints[j].parent < 0) continue;
    const auto parent = static_cast<std::size_t>(skeleton_.joints[j].parent);
    matched_above[j] = match_[parent] >= 0 ? static_cast<int>(parent) : matched_above[parent];
    if (match_[j] < 0 || matched_above[j] < 0) continue;
    const auto above = static_cast<std::size_t>(matched_above[j]);
    pairs.push_back({above, j, origin_of(bind_[j]) - origin_of(bind_[above]),
                     origin_of(rest_[static_cast<std::size_t>(match_[j])]) -
                         origin_of(rest_[static_cast<std::size_t>(match_[above])])});
  }
  return pairs;
}

// Of the source to the axes of the skeleton.
Quat Retarget::fit_turn() const {
  Quat best{0, 0, 0, 1};
  double best_score = -1e300, total = 0;
  for (const BonePair& pair : pairs_) total += length(pair.skeleton);
  for (const Quat& turn : axis_turns()) {
    double score = 0;
    for (const BonePair& pair : pairs_) {
      score += length(pair.skeleton) * cosine(pair.skeleton, rotate(turn, pair.source));
    }
    if (score > best_score + 1e-6 * total) {
      best_score = score;
      best = turn;
    }
  }
  return best;
}

double Retarget::fitted_unit() const {
  double metres = 0, units = 0;
  for (const BonePair& pair : pairs_) {
    metres += length(pair.skeleton);
    units += length(pair.source);
  }
  const double unit = metres / units;
  return unit > 0 && std::isfinite(unit) ? unit : 0;
}

// Joints of the source that some frame turns away from rest.
std::vector<bool> Retarget::turning_joints(std::size_t frames, double fps) const {
  constexpr double kNoTurn = 1e-6;  // 1 less the cosine of half the turn
  std::vector<bool> turns(motion_.joints.size(), false);
  for (std::size_t k = 0; k < frames; ++k) {
    const std::vector<JointTransform> locals = motion_.locals_at(static_cast<double>(k) / fps);
    for (std::size_t b = 0; b < turns.size(); ++b) {
      const Quat away = conjugate(motion_.joints[b].rest.rotation) * locals[b].rotation;
      turns[b] = turns[b] || std::abs(away[3]) < 1 - kNoTurn;
    }
  }
  return turns;
}

// By the directions from their lowest to their highest matched joints.
bool Retarget::trunks_rest_alike(const std::vector<std::optional<JointRole>>& roles) const {
  constexpr double kLean = std::numbers::pi / 9;
  std::optional<std::size_t> low, high;
  const auto rank = [&](std::size_t j) { return std::pair(roles[j]->part, roles[j]->nested); };
  for (std::size_t j = 0; j < skeleton_.size(); ++j) {
    if (match_[j] < 0 || !roles[j] || !is_middle_of_trunk(*roles[j])) continue;
    if (!low || rank(j) < rank(*low)) low = j;
    if (!high || rank(j) > rank(*high)) high = j;
  }
  if (!low) return true;
  const auto source = [&](std::size_t j) { return origin_of(rest_[static_cast<std::size_t>(match_[j])]); };
  return angle_between_bones(origin_of(bind_[*high]) - origin_of(bind_[*low]),
                             rotate(turn_, source(*high) - source(*low))) < kLean;
}

// Joints without bones of their own go with the joint above.
void Retarget::align_rests(const std::vector<bool>& turns, std::vector<std::string>& notes) {
  constexpr double kFeetAlike = std::numbers::pi / 4;
  const std::vector<std::optional<JointRole>> roles = joint_roles(named_joints(skeleton_));
  const bool trunks_alike = trunks_rest_alike(roles);
  std::vector<std::vector<const BonePair*>> bones(skeleton_.size());
  for (const BonePair& pair : pairs_) {
    if (turns[static_cast<std::size_t>(match_[pair.above])]) bones[pair.above].push_back(&pair);
  }
  double worst = 0;
  std::string worst_joint;
  for (std::size_t j = 0; j < skeleton_.size(); ++j) {
    const int parent = skeleton_.joints[j].parent;
    if (parent >= 0) alignment_[j] = alignment_[static_cast<std::size_t>(parent)];
    std::vector<Vec3> from, to;
    double apart = 0;
    const BonePair* farthest = nullptr;
    for (const BonePair* bone : bones[j]) {
      from.push_back(rotate(alignment_[j], bone->skeleton));
      to.push_back(rotate(turn_, bone->source));
      const double angle = angle_between_bones(bone->skeleton, to.back());
      if (angle <= apart) continue;
      apart = angle;
      farthest = bone;
    }
    const bool is_foot = roles[j] && roles[j]->part == BodyPart::foot;
    if ((is_foot && apart < kFeetAlike) || (roles[j] && is_of_trunk(*roles[j]) && trunks_alike)) {
      alignment_[j] = {0, 0, 0, 1};
      continue;
    }
    if (from.empty()) continue;
    alignment_[j] = normalized(fit_rotation(from, to) * alignment_[j]);
    if (apart <= worst) continue;
    worst = apart;
    worst_joint = skeleton_.joints[farthest->joint].name;
  }
  if (worst > 1e-3) {
    notes.push_back("The rest poses of " + motion_.kind + " and character differ by up to " +
                    rounded(worst * 180 / std::numbers::pi) + " degrees (the bone to '" + worst_joint +
                    "'); the bones were laid along each other.");
  }
  if (std::abs(turn_[3]) < 0.999) {
    notes.push_back("The " + motion_.kind + " was turned to the character's axes (another axis is up).");
  }
}

// A displacement in the source's axes at rest, in the space of a joint of the skeleton.
Vec3 Retarget::in_bind_axes(std::size_t joint, const Vec3& displacement) const {
  const Affine to_joint = inverse(bind_[joint]);
  return to_joint * rotate(turn_, displacement) - to_joint * Vec3{0, 0, 0};
}

Pose Retarget::at(double seconds, double unit) const {
  const std::vector<JointTransform> local = motion_.locals_at(seconds);
  const std::vector<Quat> rotations = source_rotations(motion_.joints, local);
  const std::vector<Affine> transforms = source_transforms(motion_.joints, local);
  Pose pose = base_;
  std::vector<Quat> rotation(skeleton_.size());
  std::vector<Affine> posed(skeleton_.size());
  for (std::size_t j = 0; j < skeleton_.size(); ++j) {
    const bool is_root = skeleton_.joints[j].parent < 0;
    const auto parent = static_cast<std::size_t>(is_root ? 0 : skeleton_.joints[j].parent);
    const Quat above = is_root ? Quat{0, 0, 0, 1} : rotation[parent];
    const Affine above_posed = is_root ? Affine{} : posed[parent];
    JointTransform& own = pose.joints[j];
    if (match_[j] >= 0) {
      const auto b = static_cast<std::size_t>(match_[j]);
      const SourceJoint& source = motion_.joints[b];
      const Quat away = rotations[b] * conjugate(rest_rotation_[b]);
      const Quat change = turn_ * away * conjugate(turn_);
      own.rotation = normalized(conjugate(above) * change * alignment_[j] * bind_rotation_[j]);
      if (!below_match_[j]) {
        if (travels_[b]) own.translation = inverse(above_posed) * (unit * rotate(turn_, origin_of(transforms[b])));
      } else if (source.has_travel && source.joint.parent >= 0) {
        const Affine& rest_above = rest_[static_cast<std::size_t>(source.joint.parent)];
        const Vec3 moved = rest_above * local[b].translation - rest_above * source.rest.translation;
        own.translation = own.translation + in_bind_axes(parent, unit * moved);
      }
    }
    rotation[j] = above * normalized(own.rotation);
    posed[j] = above_posed * affine_from(own);
  }
  return pose;
}

}  // namespace bodyopt
