// A character with what its skin shows beside its shape.
#pragma once

#include "assets/character.h"
#include "assets/skin_surface.h"
#include "base/content_hash.h"

namespace bodyopt {

// Writes a .glb with one skinned mesh in output vertex order, a primitive for each material that a triangle has. All
// primitives share the vertices. Throws Error(file).
void write_character(const Character& character, const SkinSurface& surface, const std::filesystem::path& path);

// A hash of a character, to know it again.

// Its welded skin, weights and skeleton: all that a shape in a pose depends on.
void add(ContentHash& hash, const Character& character);

}  // namespace bodyopt
