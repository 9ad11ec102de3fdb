// A character with what its skin shows beside its shape.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>

#include "assets/characters/character.h"
#include "assets/gltf/skin_surface.h"
#include "runtime/core/json.h"

namespace bodyopt {

class GlbWriter;

// Adds the vertices of a glTF mesh: POSITION and NORMAL at rest, JOINTS_n, WEIGHTS_n. `places`: the output vertex of
// each.
Json bound_vertices(const Character& character, std::span<const std::uint32_t> places, GlbWriter& glb);

// Writes a .glb with one skinned mesh in output vertex order, a primitive for each material that a triangle has. All
// primitives share the vertices. Throws Error(file).
void write_character(const Character& character, const SkinSurface& surface, const std::filesystem::path& path);

}  // namespace bodyopt
