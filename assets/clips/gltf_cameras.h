// Cameras of a glTF file, as its nodes move them.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "assets/clips/clip.h"
#include "assets/gltf/gltf_file.h"

namespace bodyopt {

// `unit`: metres per file unit; `world_at(k)`: per node, from its space to the world at frame k of `frames`, metres.
// What is no camera as glTF has it is left out with a note.
std::vector<ClipCamera> read_gltf_cameras(const GltfFile& file, double unit, std::size_t frames,
                                          const std::function<std::vector<Affine>(std::size_t)>& world_at,
                                          std::vector<std::string>& notes);

}  // namespace bodyopt
