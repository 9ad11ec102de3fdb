// FBX as glTF: the one way by which characters and clips from FBX come in, past the same checks as any .glb.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace bodyopt {

// The bytes of a .glb, metres, Y up. Nodes are the file's models, with pivots and pre-rotations in their transforms.
// Points of each mesh are numbered as in the file. Every skeleton has a skin. Every stack that moves a node has an
// animation, from time 0 on. Normals and vertex colours are left out. Messages call the file `path`. Throws
// Error(file), also where a part cannot be read right.
std::string glb_of_fbx(const std::filesystem::path& path, std::string_view bytes);

}  // namespace bodyopt
