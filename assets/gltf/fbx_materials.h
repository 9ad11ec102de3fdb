// The materials of an FBX file as those of glTF: base colours, and their images, in the file or beside it.
#pragma once

#include <filesystem>
#include <map>

#include "assets/fbx/fbx_scene.h"

namespace bodyopt {

class GlbWriter;

// Returns the number of each material's glTF by its id. Throws Error(file).
std::map<std::int64_t, std::size_t> add_fbx_materials(const FbxScene& scene, const std::filesystem::path& path,
                                                      GlbWriter& glb);

}  // namespace bodyopt
