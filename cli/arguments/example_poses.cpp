#include "cli/arguments/example_poses.h"

#include "cli/arguments/common.h"

namespace bodyopt::cli {

std::vector<Pose> read_poses(const std::vector<std::string>& sources, const Skeleton& skeleton, double unit,
                             const std::string& joint_map) {
  std::vector<Pose> poses;
  for (const std::string& source : sources) {
    ClipOptions options;
    options.unit = clip_unit(source, unit);
    options.joint_map = joint_map;
    const Clip clip = read_clip(source, skeleton, options);
    say(clip.notes);
    poses.insert(poses.end(), clip.poses.begin(), clip.poses.end());
  }
  return poses;
}

}  // namespace bodyopt::cli
