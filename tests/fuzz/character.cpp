#include "assets/character.h"

#include "assets/gltf_skin.h"
#include "tests/assets/gltf_blob.h"
#include "tests/fuzz/fuzz_target.h"

namespace bodyopt::fuzz {
namespace {

std::vector<std::string> seeds() {
  GltfBlob coloured = two_joint_square();
  coloured.root["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] =
      coloured.vectors({0, 0, 0, 0, 0.5f, 0, 1, 0, 0, 0, 0, 1});
  return {coloured.glb()};
}

void read(const std::string& bytes) {
  const std::filesystem::path path = as_file("character.glb", bytes);
  const Character character = read_character(path, 0.1);
  require_finite(std::vector(character.vertices.data(), character.vertices.data() + character.vertices.size()),
                 "vertices");
  for (const std::vector<JointWeight>& weights : character.weights) {
    for (const JointWeight& weight : weights) require_finite(std::vector{weight.weight}, "weights");
  }
  require_finite(read_vertex_colours(path, "COLOR_0"), "colours");
}

const bool added = add_target({"character", seeds, read});

}  // namespace
}  // namespace bodyopt::fuzz
