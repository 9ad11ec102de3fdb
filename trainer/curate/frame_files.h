// A frame as a mesh for the artist's own tool, and back: Wavefront OBJ, or glTF (.glb) with the skeleton in the frame's
// pose. Metres.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "assets/characters/character_write.h"
#include "runtime/host/rig.h"
#include "trainer/curate/pose_database.h"

namespace bodyopt::trainer {

// The surface of a frame's mesh is for the artist, and for its vertices to be recognised. It has the texture
// coordinates of the character's own file. It has a material for each painted region, or for each joint where those do
// not cover the skin. A triangle is of the one that weighs most. Throws Error(file).
SkinSurface frame_surface(const PoseDatabase& database);

// The mark that names a mesh, so that its export is recognised when it comes back.
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

// The most that vertices of a skin (V x 3) move by the rounding of files alone.
double unmoved_distance(const Positions& skin);

// Reads a mesh made of one of the skins `written` (one at least). That is the skin whose mark it has; without a mark,
// the first of those that most of its vertices lie on. `texture`: of its surface. Vertices may stand in any order, as
// match_vertices() finds them. In an OBJ of as many and with the character's faces (some may be missing or joined),
// their numbers count, which sculpting programs keep. A mesh with another axis up is turned by turn_back(). Throws
// Error(mismatch), with both counts and the likely cause, at other vertices or faces, or at five times the size or a
// fifth. Throws as turn_back(), too, and Error(file) at what is malformed.
FrameMesh read_frame_mesh(const Character& character, const std::vector<double>& texture,
                          std::span<const WrittenSkin> written, const std::filesystem::path& path);

}  // namespace bodyopt::trainer
