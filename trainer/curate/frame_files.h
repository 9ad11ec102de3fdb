// A frame as a mesh for the artist's own tool, and back: Wavefront OBJ, or glTF (.glb) with the skeleton in the frame's
// pose. Metres.
#pragma once

#include <filesystem>
#include <vector>

#include "assets/character.h"
#include "runtime/host/rig.h"

namespace bodyopt {

// positions: O x 3, vertices in the order of the character's file. Throws Error(file).
void write_frame_obj(const Character& character, const std::vector<float>& positions,
                     const std::filesystem::path& path);
// skin: V x 3. The mesh rests in it, on the skeleton posed.
void write_frame_gltf(const Character& character, const Positions& skin, const Pose& pose,
                      const std::filesystem::path& path);

// O x 3 from a mesh that was made of a frame (`exported`: V x 3, as it was written). Vertices may stand in any order:
// in an OBJ of as many, whose faces are the character's, they are known by their numbers, which sculpting programs keep
// (faces may have been left out, or joined to larger ones); otherwise as match_vertices() tells. Throws
// Error(mismatch), with both counts and the likely cause, where the mesh is of other vertices or faces; Error(file) at
// what is malformed.
std::vector<float> read_frame_mesh(const Character& character, const Positions& exported,
                                   const std::filesystem::path& path);

}  // namespace bodyopt
