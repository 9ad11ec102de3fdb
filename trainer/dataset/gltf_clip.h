// Clips from glTF animations.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "trainer/dataset/clip.h"

namespace bodyopt {

// `name`: the animation; empty takes the first. The local transforms of the clip's nodes are applied to the joints of
// the same names as they are, even where the two files rest differently; what the clip does not animate stays as the
// skeleton's default. Nodes above a joint that are no joints themselves are composed in, as for characters.
Clip read_gltf_clip(const std::filesystem::path& path, const std::string& name, const Skeleton& skeleton,
                    const ClipOptions& options);

// As clip_keys(), for a clip that read_gltf_clip() reads.
std::vector<int> read_gltf_keys(const std::filesystem::path& path, const std::string& name, const ClipOptions& options);

}  // namespace bodyopt
