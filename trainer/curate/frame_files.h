// A frame as a mesh for the artist's own tool, and back: Wavefront OBJ, metres, output vertices in their order.
#pragma once

#include <filesystem>
#include <vector>

#include "assets/character.h"

namespace bodyopt {

// positions: O x 3. Throws Error(file).
void write_obj(const Character& character, const std::vector<float>& positions, const std::filesystem::path& path);

// O x 3. Vertices are known by their numbers, which sculpting programs keep; faces may have been left out or joined to
// larger ones. Throws Error(mismatch), with both counts and the likely cause, where the mesh has another number of
// vertices, or faces between others than the character's neighbours; Error(file) at what is malformed.
std::vector<float> read_obj(const Character& character, const std::filesystem::path& path);

}  // namespace bodyopt
