// Meshes of a glTF file that are to follow a character's skin, brought to its rest space.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "assets/character.h"
#include "assets/gltf_file.h"
#include "runtime/basis/basis.h"

namespace bodyopt {

struct LooseMesh {
  std::string name;            // of its node or mesh, as attachment_name; each once
  std::vector<Vec3> vertices;  // N, rest space of the character, metres, in the file's order
  std::vector<std::array<std::uint32_t, 3>> triangles;
  int joint = -1;                                 // the character's joint that its node hangs on, or -1
  std::vector<std::vector<JointWeight>> weights;  // N where it has a skin of its own: by joint of the character
  std::size_t node = 0;                           // of the file
};

// A mesh below a joint's node stands where that joint has it in the bind pose, a skinned one where its own bind pose
// brings it, any other where the file's nodes put it. Joints are matched by name. `unit`: metres per file unit.
// Where a skin of the file has `skin_vertices`, as many as the character puts out, the file is the character's own:
// that skin is left out, and so is, with a note, what hangs on no joint (floors, lights) or cannot be used. Throws
// Error(file), and Error(mismatch) for skins on joints that the character does not have.
std::vector<LooseMesh> read_loose_meshes(const GltfFile& file, const Skeleton& skeleton, std::size_t skin_vertices,
                                         double unit, std::vector<std::string>& notes);

}  // namespace bodyopt
