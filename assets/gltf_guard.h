// What is checked and taken out of a glTF file before tinygltf sees it.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace bodyopt {

struct GuardedGltf {
  std::string json;  // without buffers, images, extras and extensions; materials have names and colours
  std::vector<std::vector<unsigned char>> buffers;  // as long as the file says they are
};

// Of a file's bytes; messages call it `path`, beside which its buffers may lie. Throws Error(file).
GuardedGltf guard_gltf(const std::filesystem::path& path, std::string_view bytes);
// Throws Error(file).
std::string read_gltf_bytes(const std::filesystem::path& path);

// The file itself, and what lies beside a .gltf: its buffers. Those it names wrongly are left out.
std::vector<std::filesystem::path> gltf_files(const std::filesystem::path& path);

}  // namespace bodyopt
