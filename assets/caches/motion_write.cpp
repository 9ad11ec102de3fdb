#include "assets/caches/motion_write.h"

#include "assets/caches/usda_skeleton.h"
#include "assets/clips/bvh_clip.h"
#include "assets/clips/clip_common.h"
#include "assets/clips/gltf_motion.h"

namespace bodyopt {

void write_motion(const Clip& clip, const Skeleton& skeleton, double unit, const std::filesystem::path& path) {
  require_poses(clip, skeleton, path);
  if (path.extension() == ".usda") return write_usd_skeleton(with_continuous_rotations(clip), skeleton, path);
  if (path.extension() == ".bvh") return write_bvh(clip, skeleton, path);
  write_clip(clip, skeleton, unit, path);
}

}  // namespace bodyopt
