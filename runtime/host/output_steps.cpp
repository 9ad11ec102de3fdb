#include "runtime/host/output_steps.h"

namespace bodyopt {

OutputSteps output_steps(const Basis& basis) {
  const SkinModifiers& modifiers = basis.modifiers;
  const std::uint32_t vertices = basis.mesh.vertex_count(), components = modifiers.component_count();
  OutputSteps steps;
  if (const SkinModifier* relax = modifiers.of_type(kRelax)) {
    steps.relax.assign(kRelaxSteps, {vertices, components, relax->first_component});
  }
  if (const SkinModifier* push_out = modifiers.of_type(kPushOut)) {
    steps.separate.assign(kSeparateSteps, {vertices, components, 0, push_out->numbers[0]});
    steps.separate.back().last = 1;
  }
  return steps;
}

}  // namespace bodyopt
