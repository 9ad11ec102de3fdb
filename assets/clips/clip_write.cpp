#include <algorithm>
#include <nlohmann/json.hpp>

#include "assets/clips/clip.h"
#include "assets/clips/clip_common.h"
#include "assets/clips/gltf_motion.h"
#include "assets/gltf/gltf_write.h"
#include "runtime/core/error.h"

namespace bodyopt {

void require_poses(const Clip& clip, const Skeleton& skeleton, const std::filesystem::path& path) {
  const auto fits = [&](const Pose& pose) { return pose.joints.size() == skeleton.size(); };
  if (clip.poses.empty() || skeleton.size() == 0 || !(clip.fps > 0) || !std::ranges::all_of(clip.poses, fits)) {
    throw Error(ErrorKind::file, path, ": not written; the clip has no frames, or not the skeleton's joints");
  }
}

void write_clip(const Clip& source, const Skeleton& skeleton, const std::filesystem::path& path) {
  require_poses(source, skeleton, path);
  const Clip clip = with_continuous_rotations(source);
  GlbWriter glb;
  glb.add_skin(skeleton, glb.add_skeleton(skeleton));
  glb.root["animations"].push_back(motion_animation(clip, skeleton, glb));
  glb.write(path);
}

void write_clip(Clip clip, Skeleton skeleton, double unit, const std::filesystem::path& path) {
  const double per_metre = unit > 0 ? 1 / unit : 1;
  const auto rescale = [per_metre](JointTransform& transform) {
    transform.translation = per_metre * transform.translation;
  };
  for (Joint& joint : skeleton.joints) {
    rescale(joint.bind);
    rescale(joint.default_local);
    for (auto& row : joint.inverse_bind.m) row[3] *= per_metre;
  }
  for (Pose& pose : clip.poses) {
    for (JointTransform& joint : pose.joints) rescale(joint);
  }
  write_clip(clip, skeleton, path);
}

}  // namespace bodyopt
