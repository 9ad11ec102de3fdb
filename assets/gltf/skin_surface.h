// The surface of a character's skin, beside its shape: materials, textures and colours.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "assets/gltf/surface_materials.h"
#include "runtime/core/json.h"

namespace bodyopt {

class GlbWriter;
struct MeshTable;

struct SkinSurface {
  std::vector<double> texture;                 // O x 2, or R x 2, as glTF has them; empty: none
  std::vector<SurfaceMaterial> materials;      // empty: none
  std::vector<std::size_t> material_of;        // of every output triangle, where there are materials
  std::vector<SurfaceTexture> textures{};      // of the materials
  std::vector<double> colours{};               // of the vertices: O x 3, linear; empty: none
  std::vector<std::uint32_t> texture_of{};     // of the triangles' corners, among R; empty: those of their vertices
  std::vector<std::string> notes{};            // of images that cannot be read, one sentence each
  std::vector<std::filesystem::path> files{};  // its images that lie beside the character's own, if they are there

  std::size_t row(std::span<const std::uint32_t> corners, std::size_t c) const {
    return texture_of.empty() ? corners[c] : texture_of[c];
  }
  bool empty() const { return texture.empty() && materials.empty() && colours.empty(); }
};

// Reads it from a character's own file, whose skin has these `points` and triangles, T x 3 corners. Empty where that
// has none. Throws Error(file), and Error(mismatch) where the file's skin is another.
SkinSurface read_skin_surface(const std::filesystem::path& character, std::size_t points,
                              std::span<const std::uint32_t> corners);
// Reads that of a mesh in output order.
SkinSurface read_skin_surface(const std::filesystem::path& character, const MeshTable& mesh);
// Reads that of a further mesh of the file, with its triangles, which may be turned around. Throws Error(file).
SkinSurface read_node_surface(MaterialReader& reader, std::size_t node, std::span<const std::uint32_t> corners);

// Vertices as glTF has them, each at one place in an image, of so many points: the same where the corners' rows are
// their vertices'.
struct SplitSurface {
  SkinSurface surface;
  std::vector<std::uint32_t> corners, places;  // of the triangles; of each vertex the one that it was
};
SplitSurface split_corners(SkinSurface surface, std::span<const std::uint32_t> corners, std::size_t points);
// The three values of each place.
std::vector<float> spread(std::span<const float> values, std::span<const std::uint32_t> places);

// Returns where the images of the base colours are looked up: `texture`, as the materials transform it.
std::vector<double> image_coordinates(const SkinSurface& surface, std::span<const std::uint32_t> corners);

// The primitives of a glTF mesh, one for each material that a triangle has. `drawn`: what they share, the attributes
// and morph targets; texture coordinates and colours are added.
Json surface_primitives(std::span<const std::uint32_t> corners, const SkinSurface& surface, Json drawn, GlbWriter& glb);

}  // namespace bodyopt
