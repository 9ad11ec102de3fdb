#include "runtime/host/separate_steps.h"

#include <algorithm>

namespace bodyopt {

std::vector<OutputSeparatePush> separate_steps(const Basis& basis) {
  if (basis.modifiers.folds.empty()) return {};
  const auto& stack = basis.modifiers.stack;
  const SkinModifier& modifier = *std::ranges::find(stack, kPushOut, &SkinModifier::type);
  OutputSeparatePush push{};
  push.vertex_count = basis.mesh.vertex_count();
  push.component_count = basis.modifiers.component_count();
  push.component = modifier.first_component;
  push.reach = modifier.numbers[0];
  std::vector<OutputSeparatePush> steps(kSeparateSteps, push);
  steps.back().last = 1;
  return steps;
}

}  // namespace bodyopt
