// Clips from glTF animations.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "assets/clips/clip.h"
#include "assets/gltf/gltf_file.h"

namespace bodyopt {

// `name`: the animation; empty takes the first. Joints are matched as match_joints() says. If the file's rest pose
// (read_rest()) is the bind pose, or has the same bones, the nodes' local transforms are applied as they are. Joints
// that the clip does not animate then keep the skeleton's default. Otherwise Retarget transfers the motion, and its
// travel is scaled by the bones. Nodes above a joint that are no joints are composed in, as for characters, but for a
// scale of all joints. The unit is file_unit()'s, or, where bones at rest are then 8 times the character's or an
// eighth, theirs.
Clip read_gltf_clip(const GltfFile& file, const std::string& name, const SkeletonChoice& choose,
                    const ClipOptions& options);

// Like clip_keys(), for a clip that read_gltf_clip() reads.
std::vector<int> read_gltf_keys(const std::filesystem::path& path, const std::string& name, const ClipOptions& options);

}  // namespace bodyopt
