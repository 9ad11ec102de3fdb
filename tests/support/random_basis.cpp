#include "tests/support/random_basis.h"

#include <algorithm>
#include <optional>
#include <string>

namespace bodyopt::testing {

Basis random_basis(std::uint32_t fibres, std::uint32_t coefficients) {
  Random random(fibres + 7 * coefficients);
  Basis basis;
  basis.skeleton.joints.resize(kBasisJoints);
  basis.mesh = random_mesh(random, kBasisVertices);
  basis.ddm = random_ddm(random, kBasisVertices, kBasisJoints);
  basis.strain = random_strain(random, fibres, fibres == 0 ? 0 : 30, kBasisVertices);
  const std::uint32_t features = coefficients == 0 ? 0 : 9 * (kBasisJoints - 1) + fibres + 2;
  basis.residual = random_residual(random, features, 40, coefficients, kBasisVertices);
  if (coefficients > 0) basis.residual.controls = {"breath", "flex"};
  return basis;
}

Basis with_random_modifiers(Basis basis, std::uint32_t components) {
  Random random(components);
  for (std::uint32_t k = 0; k < components; k += 2) {
    SkinModifier& modifier = basis.modifiers.stack.emplace_back();
    modifier.name = "modifier" + std::to_string(k);
    modifier.type = "morph";
    modifier.first_component = k;
    modifier.component_count = std::min(2u, components - k);
  }
  basis.modifiers.blend_begin.push_back(0);
  for (std::uint32_t first = 0; first < basis.mesh.vertex_count(); first += kBlockSize) {
    for (std::uint32_t k = random.below(5); k > 0; --k) {
      basis.modifiers.blend.push_back(random_blend_entry(random, random.uniform(0.001, 0.01), random.below(components),
                                                         basis.mesh.vertex_count() - first));
    }
    basis.modifiers.blend_begin.push_back(static_cast<std::uint32_t>(basis.modifiers.blend.size()));
  }
  return basis;
}

Basis with_on_top(Basis basis, const PosedSkinType& type) {
  const std::uint32_t component = basis.modifiers.component_count();
  SkinModifier& modifier = basis.modifiers.stack.emplace_back();
  modifier.name = modifier.type = type.name;
  modifier.first_component = component;
  modifier.component_count = type.components + 2 * type.joint_components;
  if (type.joint_components == 0) return basis;
  modifier.joints = {2, 4};
  modifier.numbers = {0.2f, 0, 0, 0, 9, 1, 0, 0, 0, 0, 0, 9, 1, 0, 0};
  for (std::size_t j = 1; j < basis.skeleton.size(); ++j) basis.skeleton.joints[j].parent = static_cast<int>(j) - 1;
  return basis;
}

std::shared_ptr<const CharacterModel> model_of(const Basis& basis) {
  return std::make_shared<const CharacterModel>(basis, std::nullopt);
}

Batch random_batch(const Basis& basis, std::uint32_t frames) {
  Random random(frames);
  Batch batch;
  batch.frame_count = frames;
  batch.skinning = random_skinning(random, kBasisJoints, frames, 0.6);
  batch.origins = random.floats(std::size_t{4} * frames, -3, 3);
  batch.joint_features = random.floats(std::size_t{9} * (kBasisJoints - 1) * frames, -1, 1);
  batch.controls = random.floats(basis.residual.controls.size() * frames, 0, 1);
  batch.modifiers = random.floats(basis.modifiers.component_count() * frames, -1, 1);
  batch.fades = random.floats(basis.residual.regions.size() * frames, 0, 1);
  return batch;
}

}  // namespace bodyopt::testing
