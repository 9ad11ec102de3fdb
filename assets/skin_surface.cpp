#include "assets/skin_surface.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "assets/gltf_file.h"
#include "assets/gltf_skeleton.h"
#include "assets/gltf_skin.h"
#include "assets/gltf_write.h"
#include "runtime/basis/basis.h"
#include "runtime/core/error.h"

namespace bodyopt {
namespace {

using Corners = std::array<std::uint32_t, 3>;

// A character that its joints mirror has its triangles turned around.
Corners in_any_turn(Corners corners) {
  std::ranges::sort(corners);
  return corners;
}

void require_same_skin(const std::filesystem::path& character, const SkinGeometry& geometry, std::size_t points,
                       std::span<const std::uint32_t> corners) {
  bool is_same = geometry.positions.size() == points && 3 * geometry.triangles.size() == corners.size();
  for (std::size_t t = 0; is_same && t < geometry.triangles.size(); ++t) {
    is_same =
        in_any_turn(geometry.triangles[t]) == in_any_turn({corners[3 * t], corners[3 * t + 1], corners[3 * t + 2]});
  }
  if (is_same) return;
  throw Error(ErrorKind::mismatch, character, ": its skin has ", geometry.positions.size(), " vertices and ",
              geometry.triangles.size(), " triangles, the skin that is written ", points, " and ", corners.size() / 3,
              ", or others: expected the file that the character was trained of, and no level of detail of it");
}

// The material of each triangle of the skin; one more, without a name, where a part has none beside parts that do.
void read_materials(const GltfFile& file, int skin, SkinSurface& surface) {
  const auto& known = file.model().materials;
  const std::vector<int> of = read_skin_materials(file, skin);
  if (std::ranges::all_of(of, [](const int material) { return material < 0; })) return;
  const bool has_bare = std::ranges::any_of(of, [](const int material) { return material < 0; });
  for (std::size_t m = 0; m < known.size(); ++m) {
    surface.materials.push_back(known[m].name.empty() ? "material_" + std::to_string(m) : known[m].name);
    std::ranges::copy_n(known[m].pbrMetallicRoughness.baseColorFactor.begin(), 4,
                        surface.colours.emplace_back().begin());
  }
  if (has_bare) {
    surface.materials.emplace_back("none");
    surface.colours.push_back({1, 1, 1, 1});
  }
  for (const int material : of) {
    surface.material_of.push_back(material < 0 ? known.size() : static_cast<std::size_t>(material));
  }
}

// Of the triangles of one material.
std::vector<std::uint32_t> corners_of(std::span<const std::uint32_t> corners, const SkinSurface& surface,
                                      std::size_t material) {
  std::vector<std::uint32_t> own;
  for (std::size_t c = 0; c < corners.size(); ++c) {
    if (surface.material_of[c / 3] == material) own.push_back(corners[c]);
  }
  return own;
}

}  // namespace

SkinSurface read_skin_surface(const std::filesystem::path& character, std::size_t points,
                              std::span<const std::uint32_t> corners) {
  const GltfFile file(character);
  const int skin = choose_skin(file);
  if (skin < 0) file.fail("has no skinned mesh");
  std::vector<std::string> unused;  // what reading the character notes already
  require_same_skin(character, read_skin_geometry(file, skin, unused), points, corners);
  SkinSurface surface;
  surface.texture = read_texture_coordinates(file);
  read_materials(file, skin, surface);
  return surface;
}

SkinSurface read_skin_surface(const std::filesystem::path& character, const MeshTable& mesh) {
  return read_skin_surface(character, mesh.output_count(), mesh.output_triangles);
}

Json surface_primitives(std::span<const std::uint32_t> corners, const SkinSurface& surface, Json drawn,
                        GlbWriter& glb) {
  if (!surface.texture.empty()) {
    const std::vector<float> texture(surface.texture.begin(), surface.texture.end());
    drawn["attributes"]["TEXCOORD_0"] = glb.add(texture, "VEC2", GlbTarget::vertices);
  }
  drawn["mode"] = 4;
  Json list = Json::array();
  const auto add = [&](std::span<const std::uint32_t> own) {
    drawn["indices"] = glb.add(own, "SCALAR", GlbTarget::indices);
    list.push_back(drawn);
  };
  if (surface.materials.empty()) add(corners);
  for (std::size_t m = 0; m < surface.materials.size(); ++m) {
    const std::vector<std::uint32_t> own = corners_of(corners, surface, m);
    if (own.empty()) continue;
    Json material = {{"name", surface.materials[m]}};
    if (!surface.colours.empty()) material["pbrMetallicRoughness"] = {{"baseColorFactor", surface.colours[m]}};
    glb.root["materials"].push_back(material);
    drawn["material"] = glb.root["materials"].size() - 1;
    add(own);
  }
  return list;
}

}  // namespace bodyopt
