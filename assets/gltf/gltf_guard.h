// Checks a glTF file, and takes parts out of it, before tinygltf sees it.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "runtime/core/json.h"

namespace bodyopt {

struct GuardedGltf {
  std::string json;  // without buffers, materials and what these name, extras and extensions
  Json look;         // `materials`, `textures`, `samplers` and `images`, as the file has them
  std::vector<std::vector<unsigned char>> buffers;  // as long as the file says they are
};

// Guards a file's bytes; messages call it `path`, beside which its buffers may lie. Throws Error(file).
GuardedGltf guard_gltf(const std::filesystem::path& path, std::string_view bytes);
// Returns the file that the URI of a buffer or an image names; messages call it `what`. With links followed, it must
// lie in the folder of the glTF file at `path`. Throws Error(file).
std::filesystem::path gltf_file_beside(const std::filesystem::path& path, const char* what, const std::string& uri);
// Throws Error(file).
std::string read_gltf_bytes(const std::filesystem::path& path);

// The file itself, and what lies beside a .gltf or .fbx: buffers, and images that are there. Those it names wrongly are
// left out. Throws Error(file) for a file that cannot be read.
std::vector<std::filesystem::path> gltf_files(const std::filesystem::path& path);

}  // namespace bodyopt
