#include "runtime/host/output_steps.h"

#include <algorithm>

#include "runtime/basis/basis.h"
#include "shaders/include/fold.h"

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

std::vector<OutputStep> output_steps(const Basis& basis, const Batch& batch, std::vector<OutputStep> steps) {
  steps.clear();
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
  const auto triangles = static_cast<std::uint32_t>(basis.mesh.triangles.size() / 3);
  return {basis.mesh.vertex_count(), triangles, box_count(triangles)};
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

}  // namespace bodyopt
