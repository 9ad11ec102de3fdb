#include "runtime/host/output_steps.h"

#include <algorithm>

namespace bodyopt {
namespace {

bool has_weight(const Basis& basis, const Batch& batch, const SkinModifier& modifier) {
  const std::size_t components = basis.modifiers.component_count();
  for (std::size_t f = 0; f < batch.frame_count; ++f) {
    const auto weights =
        std::span(batch.modifiers).subspan(f * components + modifier.first_component, modifier.component_count);
    if (std::ranges::any_of(weights, [](float weight) { return weight != 0; })) return true;
  }
  return false;
}

}  // namespace

std::vector<OutputStep> output_steps(const Basis& basis, const Batch& batch) {
  std::vector<OutputStep> steps;
  for (const SkinModifier& modifier : basis.modifiers.stack) {
    const PosedSkinType* type = posed_skin_type(modifier.type);
    if (type == nullptr || !has_weight(basis, batch, modifier)) continue;
    for (std::uint32_t k = 0; k < type->steps; ++k) steps.push_back({&modifier, type->step, k});
  }
  return steps;
}

OutputRelaxPush relax_push(const Basis& basis, const OutputStep& step) {
  const std::uint32_t vertices = basis.mesh.vertex_count();
  return {vertices, basis.modifiers.component_count(), step.modifier->first_component, 0, vertices, 0};
}

OutputBoundPush bound_push(const Basis& basis) {
  return {basis.mesh.vertex_count(), static_cast<std::uint32_t>(basis.mesh.triangles.size() / 3),
          box_count(basis.mesh)};
}

OutputSeparatePush separate_push(const Basis& basis, const OutputStep& step) {
  const OutputBoundPush bound = bound_push(basis);
  return {bound.vertex_count,
          bound.triangle_count,
          bound.box_count,
          basis.modifiers.component_count(),
          step.modifier->first_component,
          static_cast<std::uint32_t>(step.modifier->joints.size()),
          step.number,
          step.modifier->numbers[0]};
}

std::vector<char> at_or_below(const Skeleton& skeleton, std::uint32_t joint) {
  std::vector<char> found(skeleton.size());
  for (std::size_t j = 0; j < found.size(); ++j) {
    const int parent = skeleton.joints[j].parent;
    found[j] = j == joint || (parent >= 0 && found[static_cast<std::size_t>(parent)]);
  }
  return found;
}

std::uint32_t box_count(const MeshTable& mesh) {
  return (static_cast<std::uint32_t>(mesh.triangles.size() / 3) + kBoxTriangles - 1) / kBoxTriangles;
}

std::vector<std::uint32_t> fold_sides(const Basis& basis) {
  const SkinModifier* modifier = basis.modifiers.of_type(kPushOut.name);
  if (modifier == nullptr) return {};
  const std::size_t words = (modifier->joints.size() + 31) / 32;
  std::vector<std::uint32_t> sides(2 * words * basis.mesh.vertex_count());
  for (std::size_t k = 0; k < modifier->joints.size(); ++k) {
    const std::vector<char> below = at_or_below(basis.skeleton, modifier->joints[k]);
    const float* fold = &modifier->numbers[kPushOut.numbers + k * kPushOut.joint_numbers];
    for (std::size_t v = 0; v < basis.mesh.vertex_count(); ++v) {
      float squared = 0;
      for (std::size_t i = 0; i < 3; ++i) {
        const float way = basis.mesh.rest[3 * v + i] - fold[i];
        squared += way * way;
      }
      const std::uint32_t bit = 1u << k % 32;
      std::uint32_t* own = &sides[2 * words * v + k / 32];
      if (squared < fold[3] * fold[3]) own[0] |= bit;
      if (below[basis.ddm.vertices[v].base_joint]) own[words] |= bit;
    }
  }
  return sides;
}

}  // namespace bodyopt
