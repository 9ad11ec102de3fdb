#include "runtime/host/relax_steps.h"

namespace bodyopt {

std::vector<OutputRelaxPush> relax_steps(const Basis& basis, const Batch& batch) {
  const SkinModifier* relax = basis.modifiers.of_type(kRelax);
  if (relax == nullptr) return {};
  const std::uint32_t components = basis.modifiers.component_count(), component = relax->first_component;
  for (std::size_t f = 0; f < batch.frame_count; ++f) {
    if (!(batch.modifiers[f * components + component] > 0)) continue;
    return {kRelaxSteps, OutputRelaxPush{basis.mesh.vertex_count(), components, component}};
  }
  return {};
}

}  // namespace bodyopt
