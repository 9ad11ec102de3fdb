// Clips from glTF animations.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "assets/clip.h"
#include "assets/gltf_file.h"

namespace bodyopt {

// `name`: the animation; empty takes the first. Joints are matched as match_joints() says. Where the file's rest pose
// (read_rest()) is the character's bind pose, or its joints have the same bones, the local transforms of the nodes are
// applied to the joints as they are; what the clip does not animate stays as the skeleton's default. Else the motion is
// carried over as Retarget says, and how far it travels is scaled by the bones. Nodes above a joint that are no joints
// themselves are composed in, as for characters; what they scale all joints by is no joint's. The unit is what
// file_unit() finds, unless the bones at rest are then 8 times as long as the character's, or an eighth: it is theirs.
Clip read_gltf_clip(const GltfFile& file, const std::string& name, const SkeletonChoice& choose,
                    const ClipOptions& options);

// As clip_keys(), for a clip that read_gltf_clip() reads.
std::vector<int> read_gltf_keys(const std::filesystem::path& path, const std::string& name, const ClipOptions& options);

}  // namespace bodyopt
