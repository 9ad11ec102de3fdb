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

// Returns area-weighted normals, O x 3; they point up where a vertex has no area around it.
std::vector<float> normals(const Character& character) {
  Positions sums = vertex_normals(character.vertices, character.triangles);
  for (Eigen::Index v = 0; v < sums.rows(); ++v) {
    const double n = sums.row(v).norm();
    if (n > 1e-30) {
      sums.row(v) /= n;
    } else {
      sums.row(v) << 0, 1, 0;
    }
  }
  return output_from_welded(character, sums);
}

struct WeightSet {
  std::vector<std::uint16_t> joints;  // P x 4
  std::vector<float> weights;         // P x 4
};

std::vector<WeightSet> weight_sets(const Character& character, std::span<const std::uint32_t> places) {
  std::size_t most = 1;
  for (const auto& weights : character.weights) most = std::max(most, weights.size());
  std::vector<WeightSet> sets((most + 3) / 4,
                              {std::vector<std::uint16_t>(4 * places.size()), std::vector<float>(4 * places.size())});
  for (std::size_t o = 0; o < places.size(); ++o) {
    const auto& weights = character.weights[character.output_vertex[places[o]]];
    double rest = 1;  // the first weight takes the rounding of the others, so that they add up to one
    for (std::size_t k = weights.size(); k-- > 0;) {
      const auto weight = static_cast<float>(k == 0 ? rest : weights[k].weight);
      rest -= static_cast<double>(weight);
      sets[k / 4].weights[4 * o + k % 4] = weight;
      sets[k / 4].joints[4 * o + k % 4] = weight == 0 ? std::uint16_t{0} : static_cast<std::uint16_t>(weights[k].joint);
    }
  }
  return sets;
}

std::span<const std::uint32_t> flat(const Triangles& triangles) {
  return {triangles.data(), static_cast<std::size_t>(triangles.size())};
}

}  // namespace

Json bound_vertices(const Character& character, std::span<const std::uint32_t> places, GlbWriter& glb) {
  Json attributes;
  attributes["POSITION"] =
      glb.add(spread(output_from_welded(character, character.vertices), places), "VEC3", GlbTarget::vertices);
  attributes["NORMAL"] = glb.add(spread(normals(character), places), "VEC3", GlbTarget::vertices);
  const std::vector<WeightSet> sets = weight_sets(character, places);
  for (std::size_t s = 0; s < sets.size(); ++s) {
    attributes["JOINTS_" + std::to_string(s)] = glb.add(sets[s].joints, "VEC4", GlbTarget::vertices);
    attributes["WEIGHTS_" + std::to_string(s)] = glb.add(sets[s].weights, "VEC4", GlbTarget::vertices);
  }
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
