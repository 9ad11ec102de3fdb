// Meshes of a glTF file that are to follow a character's skin, brought to its rest space.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "assets/characters/character.h"
#include "assets/gltf/gltf_file.h"
#include "runtime/basis/basis.h"

namespace bodyopt::trainer {

struct LooseMesh {
  std::string name;            // of its node or mesh, as attachment_name; each once
  std::vector<Vec3> vertices;  // N, rest space of the character, metres, in the file's order
  std::vector<std::array<std::uint32_t, 3>> triangles;
  int joint = -1;                                 // the character's joint that its node hangs on, or -1
  std::vector<std::vector<JointWeight>> weights;  // N where it has a skin of its own: by joint of the character
  std::size_t node = 0;                           // of the file
};

// A mesh below a joint's node lies where that joint has it in the bind pose. A skinned mesh lies where its own bind
// pose puts it, any other where the file's nodes do. Joints are matched by name. `unit`: metres per file unit. A file
// with a skin of `skin_vertices`, the character's number of output vertices, is the character's own. That skin is left
// out; meshes on no joint (floors, lights), or of no use, are left out with a note. Throws Error(file), and
// Error(mismatch) for skins on joints that the character does not have.
std::vector<LooseMesh> read_loose_meshes(const GltfFile& file, const Skeleton& skeleton, std::size_t skin_vertices,
                                         double unit, std::vector<std::string>& notes);

}  // namespace bodyopt::trainer
