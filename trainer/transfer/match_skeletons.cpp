#include "trainer/transfer/match_skeletons.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "assets/clips/joint_match.h"
#include "assets/clips/matched_joints.h"
#include "base/wording.h"
#include "geometry/nearest_rotation.h"
#include "runtime/core/error.h"
#include "runtime/core/text.h"
#include "runtime/host/rig.h"
#include "runtime/modifiers/drive_modifiers.h"

namespace bodyopt::trainer {
namespace {

constexpr double kBuild = 35 * std::numbers::pi / 180;  // less between two bones is a difference of build
constexpr double kUnlikely = 5;                         // times as large: rather another unit than another body
constexpr double kHanded = 0.2;                         // of handedness(): less may be a posture
constexpr double kSame = 1e-3;                          // of a skeleton's size: joints of the same body

using Points = Eigen::Matrix3Xd;

Eigen::Quaterniond quaternion_of(const Quat& q) { return {q[3], q[0], q[1], q[2]}; }
Quat quat_of(const Eigen::Quaterniond& q) { return normalized({q.x(), q.y(), q.z(), q.w()}); }

struct RigidFit {
  Eigen::Matrix3d rotation;
  double size = 1;
  double left = 0;      // root mean square, over the size of `to`
  double mirrored = 0;  // the same, were reflections allowed
};

// Kabsch and Umeyama: size x rotation x from ~ to, both centred.
RigidFit fit_rigidly(Points from, Points to) {
  from.colwise() -= from.rowwise().mean().eval();
  to.colwise() -= to.rowwise().mean().eval();
  // Joints on a line tell no twist: then as little as it takes.
  const double few = 1e-12 * from.norm() * to.norm();
  const NearestRotation nearest = nearest_rotation(to * from.transpose() + few * Eigen::Matrix3d::Identity());
  const double own = std::max(from.squaredNorm(), 1e-300), other = std::max(to.squaredNorm(), 1e-300);
  const double trace = nearest.stretches.sum(), reflected = trace - 2 * nearest.stretches[2];
  const auto left = [&](double sum) { return std::sqrt(std::max(0.0, 1 - sum * sum / (own * other))); };
  return {nearest.rotation, trace / own, left(trace), left(reflected)};
}

struct PlacedRole {
  JointRole role;
  Eigen::Vector3d place;
};

// Volume of three unit vectors: from right to left (by a part that is there twice), from hips to head, from heels to
// toes. Its sign tells a body from its mirror image, however it is posed. 0 where a part is not there.
double handedness(const std::vector<PlacedRole>& joints, BodyPart pair) {
  const auto find = [&](BodyPart part, BodySide side) {
    const auto found = std::ranges::find_if(
        joints, [&](const PlacedRole& joint) { return joint.role.part == part && joint.role.side == side; });
    return found == joints.end() ? nullptr : &found->place;
  };
  const Eigen::Vector3d *left = find(pair, BodySide::left), *right = find(pair, BodySide::right),
                        *hips = find(BodyPart::hips, BodySide::middle), *top = find(BodyPart::head, BodySide::middle);
  if (top == nullptr) top = find(BodyPart::neck, BodySide::middle);
  Eigen::Vector3d ahead = Eigen::Vector3d::Zero();
  for (const BodySide side : {BodySide::left, BodySide::right}) {
    const Eigen::Vector3d *heel = find(BodyPart::foot, side), *toe = find(BodyPart::toe, side);
    if (heel != nullptr && toe != nullptr) ahead += (*toe - *heel).normalized();
  }
  if (left == nullptr || right == nullptr || hips == nullptr || top == nullptr) return 0;
  return (*left - *right).normalized().dot((*top - *hips).normalized().cross(ahead.normalized()));
}

double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

// Asks for the unit that is likely where one body is `ratio` times as large as another.
std::string note_of_units(double ratio) {
  struct Unit {
    const char* name;
    double metres;
  };
  constexpr Unit kUnits[] = {
      {"millimetres", 0.001}, {"centimetres", 0.01}, {"inches", 0.0254}, {"decimetres", 0.1}, {"feet", 0.3048}};
  const double metres = 1 / std::max(ratio, 1 / ratio);
  const Unit likely =
      *std::ranges::min_element(kUnits, {}, [&](const Unit& unit) { return std::abs(std::log(unit.metres / metres)); });
  return concat("the target's bones are ", formatted("%.3g", ratio), " times as long as the source's: is ",
                ratio > 1 ? "its" : "the source's", " file in ", likely.name, ", and was read as if in metres (--unit ",
                formatted("%.4g", likely.metres), ")?");
}

class SkeletonAligner {
 public:
  SkeletonAligner(const Skeleton& source, const Skeleton& target, SkeletonMatch& match)
      : target_(target),
        match_(match),
        from_(joint_places(target, bind_pose(target)).transpose()),
        to_(joint_places(source, bind_pose(source)).transpose()),
        roles_(joint_roles(named_joints(target))),
        source_roles_(joint_roles(named_joints(source))) {
    collect_bones();
  }

  void align() {
    const Quat whole = align_whole();
    match_.alignment.resize(target_.size());
    for (std::size_t j = 0; j < target_.size(); ++j) {
      const int parent = target_.joints[j].parent;
      const Quat inherited = parent < 0 ? whole : match_.alignment[static_cast<std::size_t>(parent)];
      match_.alignment[j] = align_joint(j, inherited);
    }
    pose_in_common();
  }

 private:
  // The bones of each matched joint: to the nearest matched joints below.
  void collect_bones() {
    bones_.resize(target_.size());
    double own = 0, other = 0;
    for (std::size_t j = 0; j < target_.size(); ++j) {
      if (match_.source_joint[j] < 0) continue;
      const int above = matched_at_or_above(target_, match_.source_joint, target_.joints[j].parent);
      if (above < 0) continue;
      const auto a = static_cast<std::size_t>(above);
      const Eigen::Vector3d from = at(from_, j) - at(from_, a), to = source_at(j) - source_at(a);
      own += from.norm();
      other += to.norm();
      if (from.norm() > 0 && to.norm() > 0) bones_[a].emplace_back(from, to);
    }
    if (!(own > 0) || !(other > 0)) {
      throw Error(ErrorKind::mismatch,
                  "no two matched joints of the two characters stand apart: nothing tells how large "
                  "the one is beside the other; a joint map (--map) may match more");
    }
    match_.size = own / other;
    match_.other_proportions = deviation_of_ratios(own, other);
    if (match_.size > kUnlikely || match_.size < 1 / kUnlikely) match_.notes.push_back(note_of_units(match_.size));
  }

  double deviation_of_ratios(double own, double other) const {
    double count = 0, sum = 0, squares = 0;
    for (const auto& of_joint : bones_) {
      for (const auto& [from, to] : of_joint) {
        const double weight = from.norm() / own + to.norm() / other, ratio = std::log(from.norm() / to.norm());
        count += weight;
        sum += weight * ratio;
        squares += weight * ratio * ratio;
      }
    }
    return count > 0 ? std::sqrt(std::max(0.0, squares / count - std::pow(sum / count, 2))) : 0;
  }

  static Eigen::Vector3d at(const Points& points, std::size_t j) { return points.col(static_cast<Eigen::Index>(j)); }
  Eigen::Vector3d source_at(std::size_t j) const { return at(to_, static_cast<std::size_t>(match_.source_joint[j])); }

  // Compares the sides of both bodies by their matched joints, whose roles either name tells.
  void require_same_sides() const {
    std::vector<PlacedRole> own, other;
    for (std::size_t j = 0; j < target_.size(); ++j) {
      if (match_.source_joint[j] < 0) continue;
      const auto& of_source = source_roles_[static_cast<std::size_t>(match_.source_joint[j])];
      const auto& role = of_source ? of_source : roles_[j];
      if (!role) continue;
      own.push_back({*role, at(from_, j)});
      other.push_back({*role, source_at(j)});
    }
    for (const BodyPart pair : {BodyPart::thigh, BodyPart::upper_arm}) {
      const double a = handedness(own, pair), b = handedness(other, pair);
      if (a * b < 0 && std::min(std::abs(a), std::abs(b)) > kHanded) refuse_mirrored();
    }
  }

  [[noreturn]] static void refuse_mirrored() {
    throw Error(ErrorKind::mismatch,
                "the target's joints, as they are matched, are the mirror image of the source's (left is right): "
                "exchange the sides in the joint map (--map), or mirror one of the two");
  }

  Quat align_whole() {
    require_same_sides();
    std::vector<Eigen::Index> own, other;
    for (std::size_t j = 0; j < target_.size(); ++j) {
      if (match_.source_joint[j] < 0) continue;
      own.push_back(static_cast<Eigen::Index>(j));
      other.push_back(match_.source_joint[j]);
    }
    const RigidFit fit = fit_rigidly(from_(Eigen::all, own), to_(Eigen::all, other));
    if (fit.mirrored < 0.25 * fit.left && fit.left > 0.05) refuse_mirrored();
    const Eigen::Quaterniond rotation(fit.rotation);
    const bool stands_alike = rotation.angularDistance(Eigen::Quaterniond::Identity()) < kBuild;
    if (fit.left > kSame && stands_alike) return {0, 0, 0, 1};
    if (fit.left <= kSame) match_.size = 1 / fit.size;
    return rotation.angularDistance(Eigen::Quaterniond::Identity()) < 1e-6 ? Quat{0, 0, 0, 1} : quat_of(rotation);
  }

  // Trunks rest alike: their short bones differ by build, and not by pose.
  bool is_of_trunk(std::size_t j) const {
    constexpr BodyPart kTrunk[] = {BodyPart::hips, BodyPart::spine,     BodyPart::neck,
                                   BodyPart::head, BodyPart::hip_joint, BodyPart::clavicle};
    return roles_[j] && std::ranges::find(kTrunk, roles_[j]->part) != std::end(kTrunk);
  }

  Quat align_joint(std::size_t j, const Quat& inherited) const {
    if (is_of_trunk(j)) return inherited;
    const Eigen::Quaterniond before = quaternion_of(inherited);
    Points from(3, static_cast<Eigen::Index>(bones_[j].size())), to = from;
    bool alike = true;
    for (std::size_t k = 0; k < bones_[j].size(); ++k) {
      const auto column = static_cast<Eigen::Index>(k);
      from.col(column) = (before * bones_[j][k].first).normalized();
      to.col(column) = bones_[j][k].second.normalized();
      alike = alike && angle_between(from.col(column), to.col(column)) < kBuild;
    }
    if (alike) return inherited;
    if (from.cols() == 1) {
      return quat_of(least_turn(from.col(0), to.col(0)) * before);
    }
    // Without centring: bones begin at the joint.
    const Eigen::Matrix3d sum = to * from.transpose() + 0.1 * Eigen::Matrix3d::Identity();
    return quat_of(Eigen::Quaterniond(nearest_rotation(sum).rotation) * before);
  }

  void pose_in_common() {
    match_.common = bind_pose(target_);
    const std::vector<Quat> bind = bind_rotations(target_);
    for (std::size_t j = 0; j < target_.size(); ++j) {
      const int parent = target_.joints[j].parent;
      const Quat own = match_.alignment[j] * bind[j];
      JointTransform& local = match_.common.joints[j];
      if (parent >= 0) {
        const auto p = static_cast<std::size_t>(parent);
        if (match_.alignment[j] != match_.alignment[p]) local.rotation = conjugate(match_.alignment[p] * bind[p]) * own;
      } else {
        local.rotation = normalized(own);
        local.translation = rotate(match_.alignment[j], local.translation);
      }
    }
  }

  const Skeleton& target_;
  SkeletonMatch& match_;
  Points from_, to_;  // bind positions of the target's joints, of the source's
  std::vector<std::optional<JointRole>> roles_, source_roles_;  // of the target's joints, of the source's
  std::vector<std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>>> bones_;  // target's, source's
};

// Joints of `skeleton` without a match, as a note.
void note_unmatched(const Skeleton& skeleton, const std::vector<int>& match, const std::string& whose,
                    const std::string& consequence, std::vector<std::string>& notes) {
  std::vector<std::string> names;
  for (std::size_t j = 0; j < skeleton.size(); ++j) {
    if (match[j] < 0) names.push_back(skeleton.joints[j].name);
  }
  if (names.empty()) return;
  notes.push_back("Joints of the " + whose + " that the other does not have: " + list_names(names, 24) + "; " +
                  consequence + ".");
}

// Adds all that follows from which joints are the same.
SkeletonMatch completed(SkeletonMatch match, const Skeleton& source, const Skeleton& target) {
  match.target_joint.assign(source.size(), -1);
  int matched = 0;
  for (std::size_t j = 0; j < target.size(); ++j) {
    if (match.source_joint[j] < 0) continue;
    match.target_joint[static_cast<std::size_t>(match.source_joint[j])] = static_cast<int>(j);
    ++matched;
  }
  if (matched < 2) {
    throw Error(ErrorKind::mismatch, "the two characters have ",
                count_of(static_cast<std::size_t>(matched), "joint", "joints"),
                " in common: they are unlike bodies, or their joints are named by no known convention; a joint map "
                "(--map) says which is which");
  }
  note_unmatched(source, match.target_joint, "source", "what they alone move follows the joint above", match.notes);
  note_unmatched(target, match.source_joint, "target", "they keep to the joint above", match.notes);
  SkeletonAligner(source, target, match).align();
  return match;
}

}  // namespace

bool SkeletonMatch::is_aligned() const {
  return std::ranges::any_of(alignment, [](const Quat& q) { return q != Quat{0, 0, 0, 1}; });
}

int matched_at_or_above(const Skeleton& skeleton, const std::vector<int>& match, int joint) {
  while (joint >= 0 && match[static_cast<std::size_t>(joint)] < 0) {
    joint = skeleton.joints[static_cast<std::size_t>(joint)].parent;
  }
  return joint;
}

Positions joint_places(const Skeleton& skeleton, const Pose& pose) {
  const std::vector<Affine> world = posed_joints(skeleton, pose.joints);
  Positions places(static_cast<Eigen::Index>(world.size()), 3);
  for (std::size_t j = 0; j < world.size(); ++j) {
    for (int i = 0; i < 3; ++i) places(static_cast<Eigen::Index>(j), i) = world[j].m[i][3];
  }
  return places;
}

Json to_json(const SkeletonMatch& match, const Skeleton& source, const Skeleton& target) {
  Json joints = Json::array();
  for (std::size_t j = 0; j < target.size(); ++j) {
    if (match.source_joint[j] < 0) continue;
    joints.push_back(
        {{"from", source.joints[static_cast<std::size_t>(match.source_joint[j])].name}, {"to", target.joints[j].name}});
  }
  return joints;
}

SkeletonMatch match_skeletons(const Skeleton& source, const Skeleton& target, const std::string& joint_map) {
  SkeletonMatch match;
  match.source_joint = match_joints(named_joints(source), target, joint_map, "the source", match.notes);
  return completed(std::move(match), source, target);
}

SkeletonMatch match_as_carried(const Skeleton& source, const Skeleton& target, const Metadata& target_metadata) {
  const std::vector<MappedJoint> joints = matched_joints(target_metadata);
  if (joints.empty()) return match_skeletons(source, target, "");
  SkeletonMatch match;
  match.source_joint.assign(target.size(), -1);
  for (const MappedJoint& joint : joints) {
    const int from = source.find(joint.from), to = target.find(joint.to);
    if (from < 0 || to < 0) return match_skeletons(source, target, "");  // it was carried from another
    match.source_joint[static_cast<std::size_t>(to)] = from;
  }
  return completed(std::move(match), source, target);
}

Pose transferred_pose(const SkeletonMatch& match, const Skeleton& source, const Skeleton& target, const Pose& pose) {
  const std::vector<Quat> source_bind = bind_rotations(source), target_bind = bind_rotations(target),
                          posed = world_rotations(source, pose);
  Pose result{match.common.joints, pose.controls};
  std::vector<Quat> world(target.size());
  for (std::size_t j = 0; j < target.size(); ++j) {
    const int parent = target.joints[j].parent, s = match.source_joint[j];
    const Quat above = parent < 0 ? Quat{0, 0, 0, 1} : world[static_cast<std::size_t>(parent)];
    JointTransform& local = result.joints[j];
    if (s >= 0) {
      const auto from = static_cast<std::size_t>(s);
      const Joint& joint = source.joints[from];
      const JointTransform& moved = pose.joints[from];
      const Quat away = posed[from] * conjugate(source_bind[from]);
      local.rotation = normalized(conjugate(above) * away * match.alignment[j] * target_bind[j]);
      const Quat source_above = joint.parent < 0 ? Quat{0, 0, 0, 1} : posed[static_cast<std::size_t>(joint.parent)];
      const Vec3 shift = rotate(source_above, moved.translation - joint.bind.translation);
      local.translation = local.translation + match.size * rotate(conjugate(above), shift);
      for (std::size_t i = 0; i < 3; ++i) local.scale[i] *= moved.scale[i] / joint.bind.scale[i];
    }
    world[j] = above * normalized(local.rotation);
  }
  return result;
}

}  // namespace bodyopt::trainer
