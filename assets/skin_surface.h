// What the skin of a character shows beside its shape.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "runtime/core/json.h"

namespace bodyopt {

class GlbWriter;
struct MeshTable;

struct SkinSurface {
  std::vector<double> texture;                   // O x 2, as glTF has them; empty: none
  std::vector<std::string> materials;            // their names; empty: none
  std::vector<std::size_t> material_of;          // of every output triangle, where there are materials
  std::vector<std::array<double, 4>> colours{};  // of the materials: red, green, blue, alpha, linear; empty: none

  bool empty() const { return texture.empty() && materials.empty(); }
};

// Of a character's own file, whose skin has these `points` and triangles, T x 3 corners; empty where that has none that
// are read, as FBX. Throws Error(file), and Error(mismatch) where the file's skin is another.
SkinSurface read_skin_surface(const std::filesystem::path& character, std::size_t points,
                              std::span<const std::uint32_t> corners);
// Of a mesh in output order.
SkinSurface read_skin_surface(const std::filesystem::path& character, const MeshTable& mesh);

// The primitives of a glTF mesh, one for each material that a triangle has. `drawn`: what they share, the attributes
// and morph targets; the texture coordinates are added.
Json surface_primitives(std::span<const std::uint32_t> corners, const SkinSurface& surface, Json drawn, GlbWriter& glb);

}  // namespace bodyopt
