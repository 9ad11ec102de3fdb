// A frame as a mesh for the artist's own tool, and back: Wavefront OBJ, or glTF (.glb) with the skeleton in the frame's
// pose. Metres.
#pragma once

#include <filesystem>
#include <vector>

#include "assets/character.h"
#include "geometry/region_weights.h"
#include "runtime/host/rig.h"
#include "trainer/curate/pose_database.h"

namespace bodyopt {

// What a mesh of a frame has beside its shape: for the artist to work with, and to know its vertices by again.
struct FrameSurface {
  std::vector<double> texture;         // O x 2, as glTF has them; empty: none
  std::vector<RegionWeights> regions;  // on welded vertices; a triangle is of the material of the one that weighs most
};

// The texture of the character's own file, and the painted regions, or the joints where none are painted. Throws
// Error(file).
FrameSurface frame_surface(const PoseDatabase& database);

// positions: O x 3, vertices in the order of the character's file. Throws Error(file).
void write_frame_obj(const Character& character, const FrameSurface& surface, const std::vector<float>& positions,
                     const std::filesystem::path& path);
// skin: V x 3. The mesh rests in it, on the skeleton posed.
void write_frame_gltf(const Character& character, const Positions& skin, const Pose& pose,
                      const std::filesystem::path& path);

// O x 3 from a mesh that was made of a frame (`exported`: V x 3, as it was written; `texture`: of its surface).
// Vertices may stand in any order: in an OBJ of as many, whose faces are the character's, they are known by their
// numbers, which sculpting programs keep (faces may have been left out, or joined to larger ones); otherwise as
// match_vertices() tells. Throws Error(mismatch), with both counts and the likely cause, where the mesh is of other
// vertices or faces; Error(file) at what is malformed.
std::vector<float> read_frame_mesh(const Character& character, const std::vector<double>& texture,
                                   const Positions& exported, const std::filesystem::path& path);

}  // namespace bodyopt
