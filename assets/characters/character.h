// A character as it comes from a file: skin, skeleton, weights. Rest space, metres.
#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "geometry/mesh.h"
#include "runtime/basis/skeleton.h"

namespace bodyopt {

class GltfFile;

struct Character {
  std::string name;
  Skeleton skeleton;
  double unit = 0;  // metres per unit of its file, where that was given or found; 0: it is in metres

  // Welded: what is solved on. Seam duplicates (same position, same weights to 1e-4) are one vertex.
  Positions vertices;                             // V x 3, rest space, metres
  Triangles triangles;                            // T x 3, welded; degenerate triangles dropped
  std::vector<std::vector<JointWeight>> weights;  // V; descending, sum 1

  // Output: the vertices of the file, in its order (primitive after primitive), and its triangles.
  std::vector<std::uint32_t> output_vertex;  // O: welded vertex of each output vertex
  Triangles output_triangles;                // T' x 3

  // Repairs and remarks from reading, one sentence each, for the user.
  std::vector<std::string> notes;

  std::uint32_t output_count() const { return static_cast<std::uint32_t>(output_vertex.size()); }

  // The first output vertex of a welded one.
  std::uint32_t first_output(std::uint32_t vertex) const {
    return static_cast<std::uint32_t>(std::ranges::find(output_vertex, vertex) - output_vertex.begin());
  }
};

// Of a vertex, one at least.
std::size_t most_weights(const Character& character);

// O x 3 to V x 3 (the first output vertex of each welded vertex) and back.
Positions welded_from_output(const Character& character, const float* output);
std::vector<float> output_from_welded(const Character& character, const Positions& welded);

// Reads .glb, .gltf, .vrm or .fbx. `unit`: metres per file unit, 0 for what file_unit() finds. Throws Error(file), also
// where some joints turn the skin inside out and others do not, or Error(mismatch).
Character read_character(const std::filesystem::path& path, double unit = 0);
Character read_character(const GltfFile& file, double unit = 0);

// Does a .glb, .gltf, .vrm or .fbx hold a skinned mesh (and not motion alone)? Throws Error(file).
bool has_skin(const std::filesystem::path& path);

// Writes a .glb with one skinned mesh in output vertex order. Throws Error(file).
void write_character(const Character& character, const std::filesystem::path& path);

}  // namespace bodyopt
