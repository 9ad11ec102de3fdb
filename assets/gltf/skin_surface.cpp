#include "assets/gltf/skin_surface.h"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <set>
#include <utility>

#include "assets/gltf/gltf_file.h"
#include "assets/gltf/gltf_skin.h"
#include "assets/gltf/gltf_write.h"
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

void require_same_skin(const std::filesystem::path& character, const SkinLook& look, std::size_t points,
                       std::span<const std::uint32_t> corners) {
  bool is_same = look.points == points && 3 * look.triangles.size() == corners.size();
  for (std::size_t t = 0; is_same && t < look.triangles.size(); ++t) {
    is_same = in_any_turn(look.triangles[t]) == in_any_turn({corners[3 * t], corners[3 * t + 1], corners[3 * t + 2]});
  }
  if (is_same) return;
  throw Error(ErrorKind::mismatch, character, ": its skin has ", look.points, " vertices and ", look.triangles.size(),
              " triangles, the skin that is written ", points, " and ", corners.size() / 3,
              ", or others: expected the file that the character was trained of, and no level of detail of it");
}

// The materials that triangles have; one more, of nothing, where a part has none beside parts that do. `corners`: the
// look's triangles, which may be turned around.
SkinSurface surface_of_look(MaterialReader& reader, SkinLook look, std::span<const std::uint32_t> corners) {
  SkinSurface surface;
  surface.texture = std::move(look.texture);
  surface.colours = std::move(look.colours);
  for (std::size_t c = 0; c < look.texture_of.size(); ++c) {
    const Corners& own = look.triangles[c / 3];
    const auto k = static_cast<std::size_t>(std::ranges::find(own, corners[c]) - own.begin());
    surface.texture_of.push_back(look.texture_of[c - c % 3 + k]);
  }
  if (std::ranges::all_of(look.materials, [](const int material) { return material < 0; })) return surface;
  std::map<int, std::size_t> known;
  for (const int material : std::set<int>(look.materials.begin(), look.materials.end())) {
    if (material >= static_cast<int>(reader.count()))
      reader.file().fail("a part of its skin has material ", material, ", which is not there");
    known[material] = surface.materials.size();
    surface.materials.push_back(material < 0 ? SurfaceMaterial{"none"}
                                             : reader.read(static_cast<std::size_t>(material), surface.textures));
  }
  surface.notes = reader.take_notes();
  surface.files = reader.take_files();
  for (const int material : look.materials) surface.material_of.push_back(known[material]);
  return surface;
}

// Adds textures to a glTF file, each image once, and returns their indices.
std::vector<std::size_t> add_textures(const std::vector<SurfaceTexture>& textures, GlbWriter& glb) {
  std::map<const std::string*, std::size_t> images;
  std::vector<std::size_t> added;
  for (const SurfaceTexture& texture : textures) {
    const auto [image, is_new] = images.try_emplace(texture.bytes.get(), glb.root["images"].size());
    if (is_new) {
      const std::size_t view = glb.add_bytes(*texture.bytes);
      glb.root["images"].push_back({{"name", texture.name}, {"mimeType", texture.type}, {"bufferView", view}});
    }
    Json json;
    if (texture.type == "image/webp") {
      glb.use("EXT_texture_webp", true);
      json["extensions"]["EXT_texture_webp"]["source"] = image->second;
    } else {
      json["source"] = image->second;
    }
    if (!texture.sampler.empty()) {
      glb.root["samplers"].push_back(texture.sampler);
      json["sampler"] = glb.root["samplers"].size() - 1;
    }
    added.push_back(glb.root["textures"].size());
    glb.root["textures"].push_back(json);
  }
  return added;
}

// Returns the corners of the triangles of one material.
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
  SkinLook look = read_skin_look(file);
  require_same_skin(character, look, points, corners);
  MaterialReader reader(file);
  return surface_of_look(reader, std::move(look), corners);
}

SkinSurface read_node_surface(MaterialReader& reader, std::size_t node, std::span<const std::uint32_t> corners) {
  return surface_of_look(reader, read_node_look(reader.file(), node), corners);
}

SplitSurface split_corners(SkinSurface surface, std::span<const std::uint32_t> corners, std::size_t points) {
  SplitSurface split{std::move(surface), {corners.begin(), corners.end()}, {}};
  SkinSurface& own = split.surface;
  if (own.texture_of.empty()) {
    split.places.resize(points);
    std::iota(split.places.begin(), split.places.end(), 0u);
    return split;
  }
  const std::vector<double> rows = std::exchange(own.texture, {}), colours = std::exchange(own.colours, {});
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> known;  // by vertex and row
  for (std::size_t c = 0; c < corners.size(); ++c) {
    const std::uint32_t vertex = corners[c], row = own.texture_of[c];
    const auto [number, is_new] = known.try_emplace({vertex, row}, static_cast<std::uint32_t>(split.places.size()));
    split.corners[c] = number->second;
    if (!is_new) continue;
    split.places.push_back(vertex);
    own.texture.insert(own.texture.end(), {rows[2 * row], rows[2 * row + 1]});
    if (!colours.empty()) own.colours.insert(own.colours.end(), &colours[3 * vertex], &colours[3 * vertex] + 3);
  }
  own.texture_of.clear();
  return split;
}

std::vector<float> spread(std::span<const float> values, std::span<const std::uint32_t> places) {
  std::vector<float> own;
  own.reserve(3 * places.size());
  for (const std::uint32_t place : places) own.insert(own.end(), &values[3 * place], &values[3 * place] + 3);
  return own;
}

std::vector<double> image_coordinates(const SkinSurface& surface, std::span<const std::uint32_t> corners) {
  std::vector<double> result = surface.texture;
  if (result.empty() || surface.materials.empty()) return result;
  std::vector<std::optional<TextureTransform>> transforms;
  for (const SurfaceMaterial& material : surface.materials) {
    transforms.push_back(material.texture() == nullptr ? std::nullopt : transform_of(*material.texture()));
  }
  for (std::size_t c = 0; c < corners.size(); ++c) {
    const std::optional<TextureTransform>& transform = transforms[surface.material_of[c / 3]];
    if (!transform) continue;
    const std::size_t row = surface.row(corners, c);
    const double* uv = &surface.texture[2 * row];
    for (std::size_t i = 0; i < 2; ++i) {
      const auto& [by_u, by_v, offset] = (*transform)[i];
      result[2 * row + i] = by_u * uv[0] + by_v * uv[1] + offset;
    }
  }
  return result;
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
  if (!surface.colours.empty()) {
    const std::vector<float> colours(surface.colours.begin(), surface.colours.end());
    drawn["attributes"]["COLOR_0"] = glb.add(colours, "VEC3", GlbTarget::vertices);
  }
  drawn["mode"] = 4;
  Json list = Json::array();
  const auto add = [&](std::span<const std::uint32_t> own) {
    drawn["indices"] = glb.add(own, "SCALAR", GlbTarget::indices);
    list.push_back(drawn);
  };
  if (surface.materials.empty()) add(corners);
  const std::vector<std::size_t> textures = add_textures(surface.textures, glb);
  for (std::size_t m = 0; m < surface.materials.size(); ++m) {
    const std::vector<std::uint32_t> own = corners_of(corners, surface, m);
    if (own.empty()) continue;
    Json material = {{"name", surface.materials[m].name}};
    material.update(surface.materials[m].gltf);
    for_each_texture(material, [&](Json& texture) {
      texture["index"] = textures[texture["index"].get<std::size_t>()];
      if (texture.contains("extensions")) glb.use("KHR_texture_transform");
    });
    glb.root["materials"].push_back(material);
    drawn["material"] = glb.root["materials"].size() - 1;
    add(own);
  }
  return list;
}

}  // namespace bodyopt
