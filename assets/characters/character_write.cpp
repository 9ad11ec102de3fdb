#include "assets/characters/character_write.h"

#include <nlohmann/json.hpp>
#include <numeric>
#include <string>
#include <vector>

#include "assets/gltf/gltf_write.h"
#include "geometry/mesh.h"
#include "runtime/core/error.h"

namespace bodyopt {
namespace {

// Joints and weights of each place, which are as many as the vertex has.
std::vector<GlbWriter::VertexWeights> rounded_weights(const Character& character,
                                                      std::span<const std::uint32_t> places) {
  std::vector<GlbWriter::VertexWeights> all;
  for (const std::uint32_t place : places) {
    const auto& weights = character.weights[character.output_vertex[place]];
    GlbWriter::VertexWeights& own = all.emplace_back(weights.size());
    double rest = 1;  // the first weight takes the rounding of the others, so that they add up to one
    for (std::size_t k = weights.size(); k-- > 0;) {
      const auto weight = static_cast<float>(k == 0 ? rest : weights[k].weight);
      rest -= static_cast<double>(weight);
      own[k] = {weight == 0 ? std::uint16_t{0} : static_cast<std::uint16_t>(weights[k].joint), weight};
    }
  }
  return all;
}

std::span<const std::uint32_t> flat(const Triangles& triangles) {
  return {triangles.data(), static_cast<std::size_t>(triangles.size())};
}

}  // namespace

Json bound_vertices(const Character& character, std::span<const std::uint32_t> places, GlbWriter& glb) {
  Json attributes;
  attributes["POSITION"] =
      glb.add(spread(output_from_welded(character, character.vertices), places), "VEC3", GlbTarget::vertices);
  const Positions normals = unit_normals(character.vertices, character.triangles);
  attributes["NORMAL"] = glb.add(spread(output_from_welded(character, normals), places), "VEC3", GlbTarget::vertices);
  glb.add_weights(rounded_weights(character, places), most_weights(character), attributes);
  return attributes;
}

void write_character(const Character& character, const std::filesystem::path& path) {
  write_character(character, {}, path);
}

void write_character(const Character& character, const SkinSurface& surface, const std::filesystem::path& path) {
  if (character.skeleton.size() > 65536 || character.skeleton.size() == 0 || character.output_triangles.rows() == 0) {
    throw Error(ErrorKind::file, path, ": not written; a character has 1 to 65,536 joints and triangles");
  }
  GlbWriter glb;
  const std::size_t skeleton = glb.add_skeleton(character.skeleton);
  std::vector<std::uint32_t> places(character.output_count());
  std::iota(places.begin(), places.end(), 0u);
  const Json attributes = bound_vertices(character, places, glb);
  const Json drawn = surface_primitives(flat(character.output_triangles), surface, {{"attributes", attributes}}, glb);
  glb.add_skin(character.skeleton, skeleton);
  glb.root["meshes"].push_back({{"name", character.name}, {"primitives", drawn}});
  glb.root["nodes"].push_back({{"name", character.name}, {"mesh", 0}, {"skin", 0}});
  glb.root["scenes"][0]["nodes"].push_back(glb.root["nodes"].size() - 1);
  glb.write(path);
}

}  // namespace bodyopt
