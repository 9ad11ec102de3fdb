#include "runtime/host/relax_steps.h"

namespace bodyopt {

std::vector<OutputRelaxPush> relax_steps(const Basis& basis, const Batch& batch) {
  const SkinModifier* relax = basis.modifiers.of_type(kRelax);
  if (relax == nullptr) return {};
  const std::uint32_t components = basis.modifiers.component_count(), component = relax->first_component;
  for (std::size_t f = 0; f < batch.frame_count; ++f) {
    if (!(batch.modifiers[f * components + component] > 0)) continue;
    const std::uint32_t vertices = basis.mesh.vertex_count();
    return {kRelaxSteps, OutputRelaxPush{vertices, components, component, 0, vertices, 0}};
  }
  return {};
}

}  // namespace bodyopt
