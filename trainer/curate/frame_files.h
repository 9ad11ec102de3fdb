// A frame as a mesh for the artist's own tool, and back: Wavefront OBJ, or glTF (.glb) with the skeleton in the frame's
// pose. Metres.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "assets/character_write.h"
#include "runtime/host/rig.h"
#include "trainer/curate/pose_database.h"

namespace bodyopt {

// What a mesh of a frame has beside its shape, for the artist to work with, and to know its vertices by again: the
// texture coordinates of the character's own file, and a material for each painted region, or joint where none are
// painted: a triangle is of the one that weighs most. Throws Error(file).
SkinSurface frame_surface(const PoseDatabase& database);

// What a mesh is named by, so that it tells which export it is of when it comes back.
std::string export_mark(std::uint64_t hash);

// positions: O x 3, vertices in the order of the character's file. `mark`: of the export, begins the object's name;
// none where it is empty. Throws Error(file).
void write_frame_obj(const Character& character, const SkinSurface& surface, const std::vector<float>& positions,
                     const std::filesystem::path& path, const std::string& mark = "");
// skin: V x 3. The mesh rests in it, on the skeleton posed.
void write_frame_gltf(const Character& character, const SkinSurface& surface, const Positions& skin, const Pose& pose,
                      const std::filesystem::path& path, const std::string& mark = "");

struct WrittenSkin {
  Positions skin;      // V x 3, as it was written
  std::string mark{};  // empty: none
};

struct FrameMesh {
  std::vector<float> positions;  // O x 3
  std::size_t of = 0;            // the written skin that it was made of
  std::size_t alike = 0;         // others, of another shape, that it may be of as well
  bool was_turned = false;       // came with another axis up, and was turned back
};

// Of vertices of a skin (V x 3): how far those move at most that nobody moved, as files round.
double unmoved_distance(const Positions& skin);

// A mesh that was made of one of the skins `written` (one at least): of that whose mark it still has; without one of
// that which most of its vertices lie on, the first of several alike. `texture`: of its surface. Vertices may stand in
// any order: in an OBJ of as many, whose faces are the character's, they are known by their numbers, which sculpting
// programs keep (faces may have been left out, or joined to larger ones); otherwise as match_vertices() tells. A mesh
// that came with another axis up is turned back, as turn_back() tells. Throws Error(mismatch), with both counts and the
// likely cause, where the mesh is of other vertices or faces, or is more than five times larger or smaller; and what
// turn_back() says; Error(file) at what is malformed.
FrameMesh read_frame_mesh(const Character& character, const std::vector<double>& texture,
                          std::span<const WrittenSkin> written, const std::filesystem::path& path);

}  // namespace bodyopt
