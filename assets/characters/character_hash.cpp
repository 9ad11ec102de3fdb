#include "assets/characters/character_hash.h"

namespace bodyopt {

void add(ContentHash& hash, const Character& character) {
  hash.append(character.vertices.data(), static_cast<std::size_t>(character.vertices.size()) * sizeof(double));
  hash.append(character.triangles.data(), static_cast<std::size_t>(character.triangles.size()) * sizeof(std::uint32_t));
  for (const std::vector<JointWeight>& weights : character.weights) {
    hash.add(static_cast<std::uint64_t>(weights.size()));
    for (const JointWeight& weight : weights) {
      hash.add(std::uint64_t{weight.joint});
      hash.add(weight.weight);
    }
  }
  for (const Joint& joint : character.skeleton.joints) {
    hash.add(joint.name);
    hash.add(static_cast<std::uint64_t>(joint.parent));
    hash.add(joint.bind);
    hash.append(&joint.inverse_bind.m, sizeof(joint.inverse_bind.m));
  }
}

}  // namespace bodyopt
