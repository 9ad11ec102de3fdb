// The geometry of a skin: every primitive of every node that uses it, or one that joints_of_skins() says is the same,
// one after the other. Morph targets are as strong as they are by default.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "assets/gltf/gltf_file.h"
#include "geometry/mesh.h"
#include "runtime/core/transform.h"

namespace bodyopt {

struct SkinGeometry {
  std::vector<Vec3> positions;                    // file units
  std::vector<std::vector<JointWeight>> weights;  // by joint of the skin, ascending; sum 1, or empty
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::string name;  // of the skinned node or its mesh; empty when unnamed
};

// Throws Error(file): attributes missing, of different counts, indices or joints out of range, points or lines.
SkinGeometry read_skin_geometry(const GltfFile& file, int skin, std::vector<std::string>& notes);

// The mesh of one node, which has one; without weights where the node has no skin. Throws as above.
SkinGeometry read_node_geometry(const GltfFile& file, std::size_t node, std::vector<std::string>& notes);

// The positions of read_skin_geometry(). Throws as above.
std::vector<Vec3> read_skin_positions(const GltfFile& file, int skin);

// Offsets of a morph target of a character's skin, O in output order, metres, rest space. They are 0 where only other
// parts of the skin have it. `unit`: as file_unit() has it. Throws Error(file), also where no part has it.
std::vector<Vec3> read_morph_target(const std::filesystem::path& character, int target, double unit);

// Red, green and blue of an attribute of a character's skin, say COLOR_0, from 0 to 1, O x 3 in output order. They are
// 0 where only other parts of the skin have it. Throws Error(file), also where no part has it.
std::vector<double> read_vertex_colours(const std::filesystem::path& character, const std::string& name);

// O x 2 in output order: texture coordinates (TEXCOORD_0) of a character's skin; empty where a part of it has none.
// Throws Error(file).
std::vector<double> read_texture_coordinates(const std::filesystem::path& character);

// Attributes that glb_of_fbx() writes; those of other files are not read. They are coordinates in images, which of them
// every triangle's corner has, and the material of every triangle.
inline constexpr char kTextureRows[] = "_ROWS", kTextureOf[] = "_ROW_OF", kMaterialOf[] = "_MATERIAL_OF";

// The look of a character's skin, or of a node's mesh, beside its shape.
struct SkinLook {
  std::size_t points = 0;  // O
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<double> texture;            // O x 2, of the set that the base colour's texture names; empty: none
  std::vector<std::uint32_t> texture_of;  // of FBX: the row of `texture` of every triangle's corner, 3T; else empty
  std::vector<double> colours;            // O x 3, COLOR_0, linear, 0 to 1; empty: none
  std::vector<int> materials;             // of each triangle the material of the file; -1: none
};
// If only some parts have coordinates or colours, those of the others are 0, and 1. Throws Error(file).
SkinLook read_skin_look(const GltfFile& file);
SkinLook read_node_look(const GltfFile& file, std::size_t node);

}  // namespace bodyopt
