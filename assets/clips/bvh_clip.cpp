#include "assets/clips/bvh_clip.h"

#include <algorithm>

#include "assets/clips/clip_common.h"
#include "assets/clips/joint_match.h"
#include "assets/clips/retarget.h"
#include "base/wording.h"
#include "runtime/core/error.h"
#include "runtime/core/transformed.h"

namespace bodyopt {
namespace {

void note_unmatched(const Bvh& bvh, const Skeleton& skeleton, const std::vector<int>& match,
                    std::vector<std::string>& notes) {
  std::vector<std::string> still, foreign;
  std::vector<bool> taken(bvh.joints.size(), false);
  for (std::size_t j = 0; j < skeleton.size(); ++j) {
    if (match[j] < 0) still.push_back(skeleton.joints[j].name);
    if (match[j] >= 0) taken[static_cast<std::size_t>(match[j])] = true;
  }
  for (std::size_t b = 0; b < bvh.joints.size(); ++b) {
    if (!taken[b]) foreign.push_back(bvh.joints[b].name);
  }
  note_names("Joints that the BVH does not have stay at rest: ", still, notes);
  note_names("BVH joints that the skeleton does not have: ", foreign, notes);
}

bool is_without_length(const BvhJoint& joint) { return joint.parent < 0 || joint.offset == Vec3{0, 0, 0}; }

// The BVH must outlive it. Position channels stand in place of offsets, which may then be zero and tell nothing.
SourceMotion motion_of(const Bvh& bvh, const std::string& up) {
  SourceMotion motion;
  motion.kind = "BVH";
  motion.up = up;
  for (std::size_t b = 0; b < bvh.joints.size(); ++b) {
    const BvhJoint& joint = bvh.joints[b];
    JointTransform rest;
    const bool is_empty = joint.parent >= 0 && joint.has_position() && is_without_length(joint);
    rest.translation = is_empty ? bvh.local(b, 0).translation : joint.offset;
    motion.joints.push_back({{joint.name, joint.parent}, rest, joint.has_position()});
  }
  motion.locals_at = [&bvh](double seconds) {
    std::vector<JointTransform> locals;
    for (std::size_t b = 0; b < bvh.joints.size(); ++b) locals.push_back(bvh.local_at(b, seconds));
    return locals;
  };
  return motion;
}

}  // namespace

Clip read_bvh_clip(const std::filesystem::path& path, const SkeletonChoice& choose, const ClipOptions& options) {
  return carry_bvh(read_bvh(path), path, choose, options);
}

Clip carry_bvh(const Bvh& bvh, const std::filesystem::path& path, const SkeletonChoice& choose,
               const ClipOptions& options) {
  std::set<std::string> names;
  for (const BvhJoint& joint : bvh.joints) names.insert(joint.name);
  const Skeleton skeleton = choose(names);
  Clip clip;
  clip.name = path.stem().string();
  clip.fps = options.fps;
  clip.first_frame = options.first_frame;
  clip.notes = bvh.notes;

  const SourceMotion motion = motion_of(bvh, options.up);
  const std::vector<NamedJoint> joints = transformed(motion.joints, &SourceJoint::joint);
  const std::vector<int> match =
      match_joints(joints, skeleton, options.joint_map, "the clip " + path.string(), clip.notes);
  if (std::ranges::all_of(match, [](int b) { return b < 0; })) {
    const std::vector<std::string> listed = transformed(joints, &NamedJoint::name);
    fail_unmatched(path.string(), skeleton, listed);
  }
  note_unmatched(bvh, skeleton, match, clip.notes);
  note_parted(skeleton, match, clip.notes);
  const std::size_t frames =
      frame_count(path.string(), bvh.duration(), std::max(skeleton.size(), bvh.joints.size()), options);
  const Retarget retarget(motion, skeleton, match, frames, options.fps, clip.notes);
  double unit = options.unit;
  if (unit == 0) {
    unit = retarget.fitted_unit();
    if (unit == 0) {
      throw Error(ErrorKind::mismatch, path, ": its unit cannot be told from its bones, since ",
                  std::ranges::all_of(bvh.joints, is_without_length) ? "all its OFFSETs are zero"
                                                                     : "too few joints match (--joint-map)",
                  "; say it (eval --unit)");
    }
    clip.notes.push_back("One BVH unit is taken as " + rounded(unit) + " m, from the length of the bones.");
  }
  for (std::size_t k = 0; k < frames; ++k) {
    clip.poses.push_back(retarget.at(static_cast<double>(k) / options.fps, unit));
  }
  check_positions(clip, path.string());
  return clip;
}

}  // namespace bodyopt
