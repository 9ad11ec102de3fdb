#include "assets/character_write.h"

#include <nlohmann/json.hpp>
#include <numeric>

#include "assets/bound_skin.h"
#include "assets/gltf_write.h"
#include "runtime/core/error.h"

namespace bodyopt {
namespace {

std::span<const std::uint32_t> flat(const Triangles& triangles) {
  return {triangles.data(), static_cast<std::size_t>(triangles.size())};
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
