// A character with what its skin shows beside its shape.
#pragma once

#include "assets/character.h"

namespace bodyopt {

struct SkinSurface {
  std::vector<double> texture;           // O x 2, as glTF has them; empty: none
  std::vector<std::string> materials;    // their names; empty: none
  std::vector<std::size_t> material_of;  // of every output triangle, where there are materials
};

// Writes a .glb with one skinned mesh in output vertex order, a primitive for each material that a triangle has. All
// primitives share the vertices. Throws Error(file).
void write_character(const Character& character, const SkinSurface& surface, const std::filesystem::path& path);

}  // namespace bodyopt
