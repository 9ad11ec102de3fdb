#include "runtime/host/output_steps.h"

#include <algorithm>

namespace bodyopt {
namespace {

// The modifier of a type, where a frame of the batch shows something of it.
const SkinModifier* shown(const Basis& basis, const Batch& batch, const char* type) {
  const SkinModifier* modifier = basis.modifiers.of_type(type);
  if (modifier == nullptr) return nullptr;
  const std::size_t components = basis.modifiers.component_count();
  for (std::size_t f = 0; f < batch.frame_count; ++f) {
    const auto weights =
        std::span(batch.modifiers).subspan(f * components + modifier->first_component, modifier->component_count);
    if (std::ranges::any_of(weights, [](float weight) { return weight > 0; })) return modifier;
  }
  return nullptr;
}

}  // namespace

OutputSteps output_steps(const Basis& basis, const Batch& batch) {
  const std::uint32_t vertices = basis.mesh.vertex_count(), components = basis.modifiers.component_count();
  OutputSteps steps;
  if (const SkinModifier* relax = shown(basis, batch, kRelax)) {
    steps.relax.assign(kRelaxSteps, {vertices, components, relax->first_component});
  }
  if (shown(basis, batch, kPushOut) != nullptr) {
    steps.separate.assign(kSeparateSteps, {vertices, components, 0});
    steps.separate.back().last = 1;
  }
  return steps;
}

}  // namespace bodyopt
