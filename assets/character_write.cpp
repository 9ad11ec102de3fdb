#include "assets/character_write.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "assets/gltf_write.h"
#include "geometry/mesh.h"
#include "runtime/core/error.h"

namespace bodyopt {
namespace {

// Area-weighted normals, O x 3; straight up where a vertex has no area around it.
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
  std::vector<std::uint16_t> joints;  // O x 4
  std::vector<float> weights;         // O x 4
};

std::vector<WeightSet> weight_sets(const Character& character) {
  std::size_t most = 1;
  for (const auto& weights : character.weights) most = std::max(most, weights.size());
  const std::size_t outputs = character.output_vertex.size();
  std::vector<WeightSet> sets((most + 3) / 4,
                              {std::vector<std::uint16_t>(4 * outputs), std::vector<float>(4 * outputs)});
  for (std::size_t o = 0; o < outputs; ++o) {
    const auto& weights = character.weights[character.output_vertex[o]];
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

std::vector<float> inverse_binds(const Skeleton& skeleton) {
  std::vector<float> columns;
  for (const Joint& joint : skeleton.joints) {
    for (int c = 0; c < 4; ++c) {
      for (int r = 0; r < 3; ++r) columns.push_back(static_cast<float>(joint.inverse_bind.m[r][c]));
      columns.push_back(c == 3 ? 1.0f : 0.0f);
    }
  }
  return columns;
}

std::span<const std::uint32_t> flat(const Triangles& triangles) {
  return {triangles.data(), static_cast<std::size_t>(triangles.size())};
}

// Of the triangles of one material.
std::vector<std::uint32_t> indices_of(const Character& character, const SkinSurface& surface, std::size_t material) {
  std::vector<std::uint32_t> indices;
  for (Eigen::Index t = 0; t < character.output_triangles.rows(); ++t) {
    if (surface.material_of[static_cast<std::size_t>(t)] != material) continue;
    for (int k = 0; k < 3; ++k) indices.push_back(character.output_triangles(t, k));
  }
  return indices;
}

Json primitives(const Character& character, const SkinSurface& surface, const Json& attributes, GlbWriter& glb) {
  if (surface.materials.empty()) {
    const std::size_t all = glb.add(flat(character.output_triangles), "SCALAR", GlbTarget::indices);
    return Json::array({{{"attributes", attributes}, {"indices", all}, {"mode", 4}}});
  }
  Json list = Json::array();
  for (std::size_t m = 0; m < surface.materials.size(); ++m) {
    const std::vector<std::uint32_t> indices = indices_of(character, surface, m);
    if (indices.empty()) continue;
    glb.root["materials"].push_back({{"name", surface.materials[m]}});
    const std::size_t own = glb.add(indices, "SCALAR", GlbTarget::indices);
    list.push_back(
        {{"attributes", attributes}, {"indices", own}, {"material", glb.root["materials"].size() - 1}, {"mode", 4}});
  }
  return list;
}

}  // namespace

void write_character(const Character& character, const std::filesystem::path& path) {
  write_character(character, {}, path);
}

void write_character(const Character& character, const SkinSurface& surface, const std::filesystem::path& path) {
  if (character.skeleton.size() > 65536 || character.skeleton.size() == 0 || character.output_triangles.rows() == 0) {
    throw Error(ErrorKind::file, path, ": not written; a character has 1 to 65,536 joints and triangles");
  }
  GlbWriter glb;
  const std::size_t skeleton = glb.add_skeleton(character.skeleton);
  Json attributes;
  attributes["POSITION"] = glb.add(output_from_welded(character, character.vertices), "VEC3", GlbTarget::vertices);
  attributes["NORMAL"] = glb.add(normals(character), "VEC3", GlbTarget::vertices);
  if (!surface.texture.empty()) {
    const std::vector<float> texture(surface.texture.begin(), surface.texture.end());
    attributes["TEXCOORD_0"] = glb.add(texture, "VEC2", GlbTarget::vertices);
  }
  const std::vector<WeightSet> sets = weight_sets(character);
  for (std::size_t s = 0; s < sets.size(); ++s) {
    attributes["JOINTS_" + std::to_string(s)] = glb.add(sets[s].joints, "VEC4", GlbTarget::vertices);
    attributes["WEIGHTS_" + std::to_string(s)] = glb.add(sets[s].weights, "VEC4", GlbTarget::vertices);
  }
  const Json drawn = primitives(character, surface, attributes, glb);
  const std::size_t binds = glb.add(inverse_binds(character.skeleton), "MAT4", GlbTarget::none);

  std::vector<std::size_t> joints(character.skeleton.size());
  for (std::size_t j = 0; j < joints.size(); ++j) joints[j] = j;
  glb.root["meshes"].push_back({{"name", character.name}, {"primitives", drawn}});
  glb.root["skins"].push_back({{"inverseBindMatrices", binds}, {"skeleton", skeleton}, {"joints", joints}});
  glb.root["nodes"].push_back({{"name", character.name}, {"mesh", 0}, {"skin", 0}});
  glb.root["scenes"][0]["nodes"].push_back(glb.root["nodes"].size() - 1);
  glb.write(path);
}

}  // namespace bodyopt
