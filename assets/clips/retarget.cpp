#include "assets/clips/retarget.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "assets/clips/axis_turns.h"
#include "assets/clips/motion_up.h"
#include "base/wording.h"
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

Eigen::Matrix3d matrix(const Quat& q) { return Eigen::Quaterniond(q[3], q[0], q[1], q[2]).toRotationMatrix(); }

Quat nearest_quaternion(const Eigen::Matrix3d& sum) {
  const Eigen::Quaterniond q(nearest_rotation(sum).rotation);
  return {q.x(), q.y(), q.z(), q.w()};
}

// The rotation that lays the bones `from` best along `to` (Kabsch). Of many such it is the nearest to `preferred`: one
// bone says nothing of the twist around it.
Quat fit_rotation(const std::vector<Vec3>& from, const std::vector<Vec3>& to, const Quat& preferred) {
  constexpr double kPreference = 1e-6;
  const auto eigen = [](const Vec3& v) { return Eigen::Vector3d(v[0], v[1], v[2]); };
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (std::size_t k = 0; k < from.size(); ++k) sum += eigen(to[k]).normalized() * eigen(from[k]).transpose();
  if (!(sum.norm() > 0)) return preferred;
  return nearest_quaternion(sum + kPreference * sum.norm() * matrix(preferred));
}

bool is_of_trunk(const std::optional<JointRole>& role) {
  return role && (role->part <= BodyPart::hip_joint || role->part == BodyPart::clavicle);
}

// Their bones are short, and go as the build has it.
bool is_short(const std::optional<JointRole>& role) {
  return role &&
         (role->part == BodyPart::neck || role->part == BodyPart::hip_joint || role->part == BodyPart::clavicle);
}

}  // namespace

Retarget::Retarget(const SourceMotion& motion, const Skeleton& skeleton, std::vector<int> match, std::size_t frames,
                   double fps, std::vector<std::string>& notes)
    : motion_(motion),
      skeleton_(skeleton),
      match_(std::move(match)),
      roles_(joint_roles(named_joints(skeleton))),
      alignment_(skeleton.size(), Quat{0, 0, 0, 1}) {
  rest_ = source_frame(motion, transformed(motion.joints, &SourceJoint::rest));
  frames_ = sampled_frames(motion, frames, fps);
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
  if (!motion.in_world) {
    is_pose_ = rests_in_a_pose(fitted);
    std::optional<Vec3> up = named_axis(motion.up), rest_up;
    if (is_pose_) rest_up = rotate(conjugate(fitted), {0, 1, 0});
    turn_ = raise(up ? *up : up_of_motion(frames_, pairs_, rest_up, notes));
  }
  stand(is_pose_ ? turn_ * conjugate(fitted) * upright : upright);
  if (!is_pose_) take_bones_of_motion();
  align_rests(notes);
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

int Retarget::matched_above(std::size_t joint) const {
  int above = skeleton_.joints[joint].parent;
  while (above >= 0 && match_[static_cast<std::size_t>(above)] < 0) {
    above = skeleton_.joints[static_cast<std::size_t>(above)].parent;
  }
  return above;
}

std::vector<BonePair> Retarget::bone_pairs() const {
  std::vector<BonePair> pairs;
  for (std::size_t j = 0; j < skeleton_.size(); ++j) {
    if (match_[j] < 0 || matched_above(j) < 0) continue;
    const auto above = static_cast<std::size_t>(matched_above(j));
    BonePair pair{above, j, static_cast<std::size_t>(match_[above]), static_cast<std::size_t>(match_[j]), {}, {}};
    pair.skeleton = bind_[j] * Vec3{0, 0, 0} - bind_[above] * Vec3{0, 0, 0};
    pair.source = rest_.bone(pair);
    pairs.push_back(pair);
  }
  return pairs;
}

// The turn of the source to the axes of the skeleton.
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

// The way from the right joint of a part to the left; zero without both.
Vec3 Retarget::leftwards(BodyPart part, const std::function<Vec3(std::size_t joint)>& place) const {
  const auto find = [&](BodySide side) {
    return std::ranges::find(roles_, std::optional(JointRole{part, side})) - roles_.begin();
  };
  const auto left = static_cast<std::size_t>(find(BodySide::left)),
             right = static_cast<std::size_t>(find(BodySide::right));
  if (std::max(left, right) >= roles_.size() || match_[left] < 0 || match_[right] < 0) return {0, 0, 0};
  return place(left) - place(right);
}

// Trunk and legs go up and down at rest as the skeleton's do, hips and shoulders lie across. No bone goes the other
// way; arms may be anywhere, and fold by 120 degrees at most.
bool Retarget::rests_in_a_pose(const Quat& fitted) const {
  constexpr double kUpright = 0.7, kAlike = 0.5;  // cosines
  const auto bound = [&](std::size_t joint) { return bind_[joint] * Vec3{0, 0, 0}; };
  const auto rests = [&](std::size_t joint) { return rest_.place(static_cast<std::size_t>(match_[joint])); };
  const auto lies_across = [&](BodyPart part) {
    return cosine(leftwards(part, bound), rotate(fitted, leftwards(part, rests))) > kAlike;
  };
  return lies_across(BodyPart::thigh) && lies_across(BodyPart::upper_arm) && turns_little() &&
         std::ranges::all_of(pairs_, [&](const BonePair& pair) {
           if (roles_[pair.joint] && roles_[pair.joint]->part >= BodyPart::clavicle) {
             const auto upper = std::ranges::find(pairs_, pair.above, &BonePair::joint);
             return roles_[pair.joint]->part <= BodyPart::upper_arm || upper == pairs_.end() ||
                    cosine(upper->source, pair.source) > -kAlike;
           }
           const bool is_upright = std::abs(cosine(pair.skeleton, {0, 1, 0})) >= kUpright;
           return cosine(pair.skeleton, rotate(fitted, pair.source)) > (is_upright ? kAlike : 0);
         });
}

// Bodies turn their joints by less than 60 degrees on the mean of all joints and frames, even as they sit with their
// arms down. Where the axes of joints are at random, it is 70 and more.
bool Retarget::turns_little() const {
  constexpr std::size_t kFewest = 8;  // joints
  double angles = 0;
  for (const BonePair& pair : pairs_) {
    angles += angle_between(mean_turn(pair.source_joint, pair.source_above), {0, 0, 0, 1});
  }
  return pairs_.size() < kFewest || angles < std::numbers::pi / 3 * static_cast<double>(pairs_.size());
}

// Takes bones' mean in the axes of the joints: unmatched joints between them may not rest in a pose. Joints that lie in
// one place have the bones from it together.
void Retarget::take_bones_of_motion() {
  for (std::size_t k = 0; k < pairs_.size(); ++k) {
    for (std::size_t n = 0; n < k; ++n) {
      const BonePair upper = pairs_[n], lower = pairs_[k];
      if (upper.joint != lower.above || length(upper.source) > 0) continue;
      pairs_.push_back({upper.above, lower.joint, upper.source_above, lower.source_joint,
                        upper.skeleton + lower.skeleton, lower.source});
    }
  }
  for (BonePair& pair : pairs_) {
    Vec3 own{0, 0, 0};
    for (const SourceFrame& frame : frames_) {
      own = own + rotate(conjugate(frame.rotation[pair.source_above]), frame.bone(pair));
    }
    pair.source = rotate(rest_.rotation[pair.source_above], (1 / static_cast<double>(frames_.size())) * own);
  }
}

bool Retarget::trunks_rest_alike() const {
  constexpr double kTurned = std::numbers::pi / 9;
  std::vector<Vec3> from, to;
  for (const BonePair& pair : pairs_) {
    if (!is_of_trunk(roles_[pair.above])) continue;
    from.push_back(pair.skeleton);
    to.push_back(rotate(turn_, pair.source));
  }
  return angle_between(fit_rotation(from, to, {0, 0, 0, 1}), {0, 0, 0, 1}) < kTurned;
}

// The bones from a joint lie to each other in the source as they do in the skeleton.
bool Retarget::trunks_are_of_one_build() const {
  constexpr double kAlike = std::numbers::pi / 36;
  std::vector<std::vector<Vec3>> from(skeleton_.size()), to(skeleton_.size());
  for (const BonePair& pair : pairs_) {
    if (!is_of_trunk(roles_[pair.above]) || !(length(pair.source) > 0)) continue;
    from[pair.above].push_back(pair.skeleton);
    to[pair.above].push_back(pair.source);
  }
  for (std::size_t j = 0; j < from.size(); ++j) {
    const Quat fitted = fit_rotation(from[j], to[j], {0, 0, 0, 1});
    for (std::size_t k = 0; k < from[j].size(); ++k) {
      if (angle_between_bones(rotate(fitted, from[j][k]), to[j][k]) > kAlike) return false;
    }
  }
  return true;
}

// The rotation is in the world's axes.
Quat Retarget::away_from_rest(const SourceFrame& frame, std::size_t joint) const {
  return turn_ * frame.rotation[joint] * conjugate(rest_.rotation[joint]) * conjugate(turn_);
}

// The mean turn, away from rest, from a joint of the source to another.
Quat Retarget::mean_turn(std::size_t joint, std::size_t other) const {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const SourceFrame& frame : frames_) {
    sum += matrix(conjugate(away_from_rest(frame, joint)) * away_from_rest(frame, other));
  }
  return nearest_quaternion(sum);
}

// The alignment by which a joint is on the mean turned from another, of `alignment`, as in the bind pose.
Quat Retarget::twisted_alike(std::size_t joint, std::size_t other, const Quat& alignment) const {
  return mean_turn(static_cast<std::size_t>(match_[joint]), static_cast<std::size_t>(match_[other])) * alignment;
}

// The alignment by which a forearm goes with the palm, since wrists do not twist. Nothing of other joints, and where
// fingers do not span a palm.
std::optional<Quat> Retarget::palm_alike(std::size_t joint) const {
  constexpr double kSpread = 0.1;  // sine
  const auto hand = std::ranges::find(pairs_, joint, &BonePair::above);
  if (!roles_[joint] || roles_[joint]->part != BodyPart::forearm || hand == pairs_.end()) return std::nullopt;
  std::vector<Vec3> from, to;
  double spread = 0;
  for (const BonePair& finger : pairs_) {
    if (finger.above != hand->joint) continue;
    from.push_back(finger.skeleton);
    to.push_back(rotate(turn_, finger.source));
    spread = std::max(spread, std::sin(angle_between_bones(to[0], to.back())));
  }
  if (spread < kSpread) return std::nullopt;
  return twisted_alike(joint, hand->joint, fit_rotation(from, to, {0, 0, 0, 1}));
}

Quat Retarget::twisted_by_motion(std::size_t joint) const {
  if (const auto told = bent_alike(joint)) return *told;
  if (const auto told = palm_alike(joint)) return *told;
  const int above = matched_above(joint);
  if (above < 0) return {0, 0, 0, 1};
  return twisted_alike(joint, static_cast<std::size_t>(above), alignment_[static_cast<std::size_t>(above)]);
}

// The alignment by which knees and elbows bend as those of bodies do: knees back, elbows of stretched out arms to the
// front. Nothing of other joints, and where they hardly bend, or this way and that.
std::optional<Quat> Retarget::bent_alike(std::size_t joint) const {
  constexpr double kBent = 0.3, kOneWay = 0.8;
  const bool is_arm = roles_[joint] && roles_[joint]->part == BodyPart::upper_arm,
             is_leg = roles_[joint] && roles_[joint]->part == BodyPart::thigh;
  const auto bone = std::ranges::find(pairs_, joint, &BonePair::above);
  if (!(is_arm || is_leg) || bone == pairs_.end()) return std::nullopt;
  const auto next = std::ranges::find(pairs_, bone->joint, &BonePair::above);
  if (next == pairs_.end()) return std::nullopt;
  const auto across = [](const Vec3& of, const Vec3& from) { return of - (dot(of, from) / dot(from, from)) * from; };
  Vec3 bend{0, 0, 0};
  double whole = 0;
  for (const SourceFrame& frame : frames_) {
    const Vec3 lower = frame.bone(*next), side = (1 / length(lower)) * across(lower, frame.bone(*bone));
    bend = bend + rotate(conjugate(frame.rotation[bone->source_above]), side);
    whole += length(side);
  }
  const Vec3 left = leftwards(BodyPart::thigh, [&](std::size_t j) { return bind_[j] * Vec3{0, 0, 0}; });
  const Vec3 bound = across(cross((is_arm ? 1 : -1) * left, {0, 1, 0}), bone->skeleton);
  const bool bends = length(bend) > kBent * static_cast<double>(frames_.size()) && length(bend) > kOneWay * whole;
  if (!bends || !(length(bound) > 0)) return std::nullopt;
  return fit_rotation({bone->skeleton, bound},
                      {rotate(turn_, bone->source), rotate(turn_ * rest_.rotation[bone->source_above], bend)},
                      {0, 0, 0, 1});
}

bool Retarget::has_bones_along_axes() const {
  constexpr double kAlong = 0.999;
  std::size_t along = 0;
  for (const BonePair& pair : pairs_) {
    const Vec3 own = rotate(conjugate(rest_.rotation[pair.source_above]), pair.source);
    const double most = std::max({std::abs(own[0]), std::abs(own[1]), std::abs(own[2])});
    if (most > kAlong * length(own)) ++along;
  }
  return 2 * along > pairs_.size();
}

// The nearest alignment that makes a joint's axes in the bind pose, but for their order, those of a joint above. It is
// the topmost or the next one.
Quat Retarget::nearest_of_axes(std::size_t joint, const Quat& alignment) const {
  Quat nearest = alignment;
  double least = std::numeric_limits<double>::max();
  const Quat own = turn_ * rest_.rotation[static_cast<std::size_t>(match_[joint])];
  const int next = matched_above(joint);
  for (int above = next; above >= 0; above = matched_above(static_cast<std::size_t>(above))) {
    const auto a = static_cast<std::size_t>(above);
    if (above != next && matched_above(a) >= 0) continue;
    const Quat axes = conjugate(alignment_[a]) * turn_ * rest_.rotation[static_cast<std::size_t>(match_[a])];
    for (const Quat& turn : axis_turns()) {
      const Quat candidate = normalized(own * conjugate(axes * turn));
      const double angle = angle_between(candidate, alignment);
      if (angle >= least) continue;
      least = angle;
      nearest = candidate;
    }
  }
  return nearest;
}

// Joints without bones of their own go with the joint above, where the source rests in a pose.
void Retarget::align_rests(std::vector<std::string>& notes) {
  constexpr double kBuildAlike = std::numbers::pi / 4, kNoWay = 2 * std::numbers::pi / 3;
  const bool trunks_alike = trunks_rest_alike(), along_axes = !is_pose_ && has_bones_along_axes();
  const bool of_one_build = trunks_are_of_one_build();
  std::vector<std::vector<const BonePair*>> bones(skeleton_.size());
  for (const BonePair& pair : pairs_) bones[pair.above].push_back(&pair);
  double worst = 0;
  std::string worst_joint;
  for (std::size_t j = 0; j < skeleton_.size(); ++j) {
    const int parent = skeleton_.joints[j].parent;
    if (parent >= 0) alignment_[j] = alignment_[static_cast<std::size_t>(parent)];
    if (match_[j] < 0) continue;
    std::vector<Vec3> from, to;
    double apart = 0, turned = 0;
    const BonePair* farthest = nullptr;
    for (const BonePair* bone : bones[j]) {
      from.push_back(bone->skeleton);
      to.push_back(rotate(turn_, bone->source));
      turned = std::max(turned, angle_between_bones(rotate(alignment_[j], bone->skeleton), to.back()));
      const double angle = angle_between_bones(bone->skeleton, to.back());
      if (angle <= apart) continue;
      apart = angle;
      farthest = bone;
    }
    const bool is_foot = roles_[j] && roles_[j]->part == BodyPart::foot,
               is_clavicle = roles_[j] && roles_[j]->part == BodyPart::clavicle,
               is_finger = roles_[j] && roles_[j]->part >= BodyPart::palm,
               is_by_build = is_foot || (is_of_trunk(roles_[j]) && trunks_alike);
    if (is_pose_ && is_by_build && (apart < kBuildAlike || !(is_foot || is_clavicle))) {
      alignment_[j] = {0, 0, 0, 1};
      continue;
    }
    if (!is_pose_ || turned > kNoWay) alignment_[j] = twisted_by_motion(j);
    if (!is_pose_ && !of_one_build && is_short(roles_[j])) continue;
    // Fingers spread, and so do their axes.
    if (along_axes && !is_finger) alignment_[j] = nearest_of_axes(j, fit_rotation(from, to, alignment_[j]));
    alignment_[j] = fit_rotation(from, to, alignment_[j]);
    if (apart <= worst) continue;
    worst = apart;
    worst_joint = skeleton_.joints[farthest->joint].name;
  }
  if (!is_pose_) {
    notes.push_back("With all rotations zero the " + motion_.kind +
                    " stands in no pose: how its joints twist about their bones was told from the motion.");
  } else if (worst > 1e-3) {
    notes.push_back("The rest poses of " + motion_.kind + " and character differ by up to " +
                    rounded(worst * 180 / std::numbers::pi) + " degrees (the bone to '" + worst_joint +
                    "'); the bones were laid along each other.");
  }
  if (std::abs(turn_[3]) < 0.999) {
    notes.push_back("The " + motion_.kind + " was turned to the character's axes (its axis " +
                    name_of_axis(rotate(conjugate(turn_), {0, 1, 0})) + " is up; --up says otherwise).");
  }
}

Pose Retarget::at(double seconds, double unit) const {
  const std::vector<JointTransform> local = motion_.locals_at(seconds);
  const SourceFrame frame = source_frame(motion_, local);
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
      own.rotation = normalized(conjugate(above) * away_from_rest(frame, b) * alignment_[j] * bind_rotation_[j]);
      if (!below_match_[j]) {
        if (travels_[b]) own.translation = inverse(above_posed) * (unit * rotate(turn_, frame.place(b)));
      } else if (source.has_travel && source.joint.parent >= 0) {
        const Affine &moves = frame.transform[static_cast<std::size_t>(source.joint.parent)],
                     to_joint = inverse(above_posed);
        const Vec3 moved = moves * local[b].translation - moves * source.rest.translation;
        own.translation = own.translation + (to_joint * rotate(turn_, unit * moved) - to_joint * Vec3{0, 0, 0});
      }
    }
    rotation[j] = above * normalized(own.rotation);
    posed[j] = above_posed * affine_from(own);
  }
  return pose;
}

}  // namespace bodyopt
