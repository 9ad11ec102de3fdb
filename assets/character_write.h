// A character with what its skin shows beside its shape.
#pragma once

#include "assets/character.h"
#include "assets/skin_surface.h"

namespace bodyopt {

// Writes a .glb with one skinned mesh in output vertex order, a primitive for each material that a triangle has. All
// primitives share the vertices. Throws Error(file).
void write_character(const Character& character, const SkinSurface& surface, const std::filesystem::path& path);

}  // namespace bodyopt
