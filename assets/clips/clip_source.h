// The name of a clip on command lines: a file, or one of the clips of a file.
#pragma once

#include <filesystem>
#include <string>

namespace bodyopt {

struct ClipSource {
  std::filesystem::path path;
  std::string name;  // of the clip within; empty: its only or first
};

// FILE.glb#name, or a file alone: a '#' may also be part of the file's name, or of a folder's.
ClipSource split_source(const std::string& source);

// ".glb" of "SHOT.GLB".
std::string lower_case_extension(const std::filesystem::path& path);

// Is it called as files are that may hold characters and their clips: .glb, .gltf, .fbx, or .vrm, which is a .glb of an
// avatar?
bool is_called_scene(const std::filesystem::path& path);

}  // namespace bodyopt
