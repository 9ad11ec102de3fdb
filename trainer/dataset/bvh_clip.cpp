#include "trainer/dataset/bvh_clip.h"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <numbers>

#include "runtime/basis/error.h"
#include "runtime/rig.h"
#include "trainer/dataset/bvh.h"
#include "trainer/dataset/clip_common.h"
#include "trainer/dataset/notes.h"

namespace bodyopt {
namespace {

std::string lower_case(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

// The BVH joint of each skeleton joint, -1 for none. A BVH joint moves one joint of the skeleton.
std::vector<int> match_joints(const Bvh& bvh, const Skeleton& skeleton, std::vector<std::string>& notes) {
  std::vector<int> match(skeleton.size(), -1);
  std::vector<bool> taken(bvh.joints.size(), false);
  const auto match_by = [&](auto key) {
    std::map<std::string, std::size_t> joints;
    std::vector<std::string> found;
    for (std::size_t b = 0; b < bvh.joints.size(); ++b) {
      if (!taken[b]) joints.try_emplace(key(bvh.joints[b].name), b);
    }
    for (std::size_t j = 0; j < skeleton.size(); ++j) {
      const auto entry = match[j] < 0 ? joints.find(key(skeleton.joints[j].name)) : joints.end();
      if (entry == joints.end()) continue;
      match[j] = static_cast<int>(entry->second);
      taken[entry->second] = true;
      found.push_back(skeleton.joints[j].name);
      joints.erase(entry);
    }
    return found;
  };
  match_by([](const std::string& name) { return name; });
  const std::vector<std::string> loosely = match_by(lower_case);
  if (!loosely.empty()) notes.push_back("Matched without regard to case: " + list_names(loosely) + ".");

  std::vector<std::string> still, foreign;
  for (std::size_t j = 0; j < skeleton.size(); ++j) {
    if (match[j] < 0) still.push_back(skeleton.joints[j].name);
  }
  for (std::size_t b = 0; b < bvh.joints.size(); ++b) {
    if (!taken[b]) foreign.push_back(bvh.joints[b].name);
  }
  if (!still.empty()) notes.push_back("Joints that the BVH does not have stay at rest: " + list_names(still) + ".");
  if (!foreign.empty()) notes.push_back("BVH joints that the skeleton does not have: " + list_names(foreign) + ".");
  return match;
}

// The same bone in both rest poses: from the nearest matched joint above to a matched joint.
struct BonePair {
  std::size_t above, joint;
  Vec3 skeleton, bvh;  // metres; file units
};

std::vector<BonePair> bone_pairs(const Bvh& bvh, const Skeleton& skeleton, const std::vector<int>& match,
                                 const std::vector<Affine>& bind) {
  std::vector<Vec3> rest;
  for (const BvhJoint& joint : bvh.joints) {
    rest.push_back(joint.parent < 0 ? joint.offset : rest[static_cast<std::size_t>(joint.parent)] + joint.offset);
  }
  const auto position = [&](std::size_t j) { return bind[j] * Vec3{0, 0, 0}; };
  std::vector<int> matched_above(skeleton.size(), -1);
  std::vector<BonePair> pairs;
  for (std::size_t j = 0; j < skeleton.size(); ++j) {
    if (skeleton.joints[j].parent < 0) continue;
    const auto parent = static_cast<std::size_t>(skeleton.joints[j].parent);
    matched_above[j] = match[parent] >= 0 ? static_cast<int>(parent) : matched_above[parent];
    if (match[j] < 0 || matched_above[j] < 0) continue;
    const auto above = static_cast<std::size_t>(matched_above[j]);
    pairs.push_back({above, j, position(j) - position(above),
                     rest[static_cast<std::size_t>(match[j])] - rest[static_cast<std::size_t>(match[above])]});
  }
  return pairs;
}

// The rotations between coordinate axes: none first, then between Z-up and Y-up, then the rest, so that the plainest
// wins a tie.
std::vector<Quat> axis_turns() {
  const double quarter = std::numbers::pi / 2;
  std::vector<Quat> turns{{0, 0, 0, 1}, axis_angle({1, 0, 0}, -quarter), axis_angle({1, 0, 0}, quarter)};
  for (int tip = 0; tip < 6; ++tip) {
    const Quat top = tip < 4 ? axis_angle({1, 0, 0}, tip * quarter) : axis_angle({0, 0, 1}, (2 * tip - 9) * quarter);
    for (int spin = 0; spin < 4; ++spin) turns.push_back(top * axis_angle({0, 1, 0}, spin * quarter));
  }
  return turns;
}

double cosine(const Vec3& a, const Vec3& b) {
  const double size = length(a) * length(b);
  return size > 0 ? dot(a, b) / size : 1;
}

Quat fit_turn(const std::vector<BonePair>& pairs) {
  Quat best{0, 0, 0, 1};
  double best_score = -1e300, total = 0;
  for (const BonePair& pair : pairs) total += length(pair.skeleton);
  for (const Quat& turn : axis_turns()) {
    double score = 0;
    for (const BonePair& pair : pairs) score += length(pair.skeleton) * cosine(pair.skeleton, rotate(turn, pair.bvh));
    if (score > best_score + 1e-6 * total) {
      best_score = score;
      best = turn;
    }
  }
  return best;
}

double fit_unit(const std::vector<BonePair>& pairs, const std::string& file) {
  double metres = 0, units = 0;
  for (const BonePair& pair : pairs) {
    metres += length(pair.skeleton);
    units += length(pair.bvh);
  }
  const double unit = metres / units;
  if (!(unit > 0) || !std::isfinite(unit)) {
    throw Error(ErrorKind::mismatch, file + ": too few joints match to tell its unit from the bones; say it (--unit)");
  }
  return unit;
}

// The rotation that lays the bones `from` best along `to` (Kabsch); of many such, the smallest.
Quat fit_rotation(const std::vector<Vec3>& from, const std::vector<Vec3>& to) {
  const auto eigen = [](const Vec3& v) { return Eigen::Vector3d(v[0], v[1], v[2]); };
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (std::size_t k = 0; k < from.size(); ++k) sum += eigen(to[k]).normalized() * eigen(from[k]).transpose();
  // The identity decides what the bones leave open: one bone says nothing of the twist around it.
  constexpr double kPreferNone = 1e-6;
  sum += kPreferNone * sum.norm() * Eigen::Matrix3d::Identity();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d u = svd.matrixU();
  if ((u * svd.matrixV().transpose()).determinant() < 0) u.col(2) *= -1;
  const Eigen::Quaterniond q(Eigen::Matrix3d(u * svd.matrixV().transpose()));
  return {q.x(), q.y(), q.z(), q.w()};
}

// Joints of the BVH that some frame turns.
std::vector<bool> turning_joints(const Bvh& bvh, std::size_t frames, double fps) {
  constexpr double kStill = 1e-6;  // 1 less the cosine of half the turn
  std::vector<bool> turns(bvh.joints.size(), false);
  for (std::size_t k = 0; k < frames; ++k) {
    for (std::size_t b = 0; b < turns.size(); ++b) {
      turns[b] = turns[b] || std::abs(bvh.local_at(b, static_cast<double>(k) / fps).rotation[3]) < 1 - kStill;
    }
  }
  return turns;
}

// Bones below a joint that never turns differ by build, not by pose (a wider pelvis, say): they are not laid along each
// other.
void drop_still(const std::vector<int>& match, const std::vector<bool>& turns, std::vector<BonePair>& pairs) {
  std::erase_if(pairs, [&](const BonePair& pair) { return !turns[static_cast<std::size_t>(match[pair.above])]; });
}

// Per joint of the skeleton, world: from its bones at bind to those of the turned BVH at rest. Joints without bones of
// their own go with the joint above.
std::vector<Quat> align_rests(const std::vector<BonePair>& pairs, const Skeleton& skeleton, const Quat& turn) {
  std::vector<std::vector<Vec3>> from(skeleton.size()), to(skeleton.size());
  std::vector<Quat> alignment(skeleton.size(), Quat{0, 0, 0, 1});
  for (const BonePair& pair : pairs) {
    from[pair.above].push_back(pair.skeleton);
    to[pair.above].push_back(rotate(turn, pair.bvh));
  }
  for (std::size_t j = 0; j < skeleton.size(); ++j) {
    if (skeleton.joints[j].parent >= 0) alignment[j] = alignment[static_cast<std::size_t>(skeleton.joints[j].parent)];
    for (Vec3& bone : from[j]) bone = rotate(alignment[j], bone);
    alignment[j] = normalized(fit_rotation(from[j], to[j]) * alignment[j]);
  }
  return alignment;
}

void note_rest_poses(const std::vector<BonePair>& pairs, const Quat& turn, const Skeleton& skeleton,
                     std::vector<std::string>& notes) {
  double worst = 0;
  std::string joint;
  for (const BonePair& pair : pairs) {
    const double angle = std::acos(std::clamp(cosine(pair.skeleton, rotate(turn, pair.bvh)), -1.0, 1.0));
    if (angle <= worst) continue;
    worst = angle;
    joint = skeleton.joints[pair.joint].name;
  }
  if (worst > 1e-3) {
    notes.push_back("The rest poses of BVH and character differ by up to " + rounded(worst * 180 / std::numbers::pi) +
                    " degrees (the bone to '" + joint + "'); the bones were laid along each other.");
  }
  if (std::abs(turn[3]) < 0.999)
    notes.push_back("The BVH was turned to the character's axes (another axis is up or front).");
}

class Retarget {
 public:
  Retarget(const Bvh& bvh, const Skeleton& skeleton, std::vector<int> match, std::vector<Affine> bind,
           std::vector<Quat> alignment, const Quat& turn, double unit)
      : bvh_(bvh),
        skeleton_(skeleton),
        match_(std::move(match)),
        bind_(std::move(bind)),
        alignment_(std::move(alignment)),
        turn_(turn),
        unit_(unit),
        bind_rotation_(bind_rotations(skeleton)) {
    for (const Joint& joint : skeleton.joints) {
      const bool is_root = joint.parent < 0;
      const auto parent = static_cast<std::size_t>(is_root ? 0 : joint.parent);
      below_match_.push_back(!is_root && (match_[parent] >= 0 || below_match_[parent]));
    }
    for (const BvhJoint& joint : bvh.joints) {
      travels_.push_back(joint.has_position() ||
                         (joint.parent >= 0 && travels_[static_cast<std::size_t>(joint.parent)]));
    }
  }

  Pose at(double seconds) const {
    const std::vector<JointTransform> local = bvh_locals(seconds);
    const std::vector<JointTransform> world = bvh_world(local);
    Pose pose = bind_pose(skeleton_);
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
        const Quat change = turn_ * world[b].rotation * conjugate(turn_);
        own.rotation = normalized(conjugate(above) * change * alignment_[j] * bind_rotation_[j]);
        if (!below_match_[j]) {
          if (travels_[b]) own.translation = inverse(above_posed) * (unit_ * rotate(turn_, world[b].translation));
        } else if (bvh_.joints[b].has_position()) {
          own.translation = own.translation + in_bind_axes(parent, local[b].translation - bvh_.joints[b].offset);
        }
      }
      rotation[j] = above * normalized(own.rotation);
      posed[j] = above_posed * affine_from(own);
    }
    return pose;
  }

 private:
  std::vector<JointTransform> bvh_locals(double seconds) const {
    std::vector<JointTransform> local;
    for (std::size_t b = 0; b < bvh_.joints.size(); ++b) local.push_back(bvh_.local_at(b, seconds));
    return local;
  }

  std::vector<JointTransform> bvh_world(const std::vector<JointTransform>& local) const {
    std::vector<JointTransform> world = local;
    for (std::size_t b = 0; b < world.size(); ++b) {
      if (bvh_.joints[b].parent < 0) continue;
      const JointTransform& above = world[static_cast<std::size_t>(bvh_.joints[b].parent)];
      world[b].rotation = normalized(above.rotation * local[b].rotation);
      world[b].translation = above.translation + rotate(above.rotation, local[b].translation);
    }
    return world;
  }

  // A displacement in BVH axes at rest, in the space of a joint of the skeleton.
  Vec3 in_bind_axes(std::size_t joint, const Vec3& displacement) const {
    const Affine to_joint = inverse(bind_[joint]);
    return to_joint * (unit_ * rotate(turn_, displacement)) - to_joint * Vec3{0, 0, 0};
  }

  const Bvh& bvh_;
  const Skeleton& skeleton_;
  std::vector<int> match_;
  std::vector<Affine> bind_;
  std::vector<Quat> alignment_;  // per joint, world: from the skeleton's bind to the BVH's rest
  Quat turn_;
  double unit_;
  std::vector<Quat> bind_rotation_;  // per joint, world
  std::vector<bool> below_match_;    // per joint: some joint above has a match
  std::vector<bool> travels_;        // per BVH joint: it or one above has position channels
};

void check_finite(const Clip& clip, const std::string& file) {
  for (const Pose& pose : clip.poses) {
    for (const JointTransform& t : pose.joints) {
      if (!std::isfinite(length(t.translation))) {
        throw Error(ErrorKind::file, file + ": its positions are out of range; the file is damaged");
      }
    }
  }
}

}  // namespace

Clip read_bvh_clip(const std::filesystem::path& path, const Skeleton& skeleton, const ClipOptions& options) {
  const Bvh bvh = read_bvh(path);
  Clip clip;
  clip.name = path.stem().string();
  clip.fps = options.fps;
  clip.first_frame = options.first_frame;

  const std::vector<int> match = match_joints(bvh, skeleton, clip.notes);
  if (std::all_of(match.begin(), match.end(), [](int b) { return b < 0; })) {
    std::vector<std::string> names;
    for (const BvhJoint& joint : bvh.joints) names.push_back(joint.name);
    fail_unmatched(path.string(), skeleton, names);
  }
  const std::vector<Affine> bind = posed_joints(skeleton, bind_pose(skeleton).joints);
  std::vector<BonePair> pairs = bone_pairs(bvh, skeleton, match, bind);
  const Quat turn = fit_turn(pairs);
  double unit = options.unit;
  if (unit == 0) {
    unit = fit_unit(pairs, path.string());
    clip.notes.push_back("One BVH unit is taken as " + rounded(unit) + " m, from the length of the bones.");
  }
  const std::size_t frames =
      frame_count(path.string(), bvh.duration(), std::max(skeleton.size(), bvh.joints.size()), options);
  drop_still(match, turning_joints(bvh, frames, options.fps), pairs);
  note_rest_poses(pairs, turn, skeleton, clip.notes);

  const Retarget retarget(bvh, skeleton, match, bind, align_rests(pairs, skeleton, turn), turn, unit);
  for (std::size_t k = 0; k < frames; ++k) clip.poses.push_back(retarget.at(static_cast<double>(k) / options.fps));
  check_finite(clip, path.string());
  return clip;
}

}  // namespace bodyopt
