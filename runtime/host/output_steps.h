// Steps of the modifiers that move the posed skin.
#pragma once

#include <vector>

#include "runtime/basis/skin_modifiers.h"
#include "runtime/host/backend.h"

namespace bodyopt {

struct OutputStep {
  const SkinModifier* modifier;  // of the basis
  PosedSkinStep kind;
  std::uint32_t number;  // of the modifier's steps, from 0
  bool operator==(const OutputStep&) const = default;
};

// The steps of a batch, in the stack's order; a modifier that no frame has a weight for has none. `steps`: memory that
// is used again.
std::vector<OutputStep> output_steps(const Basis& basis, const Batch& batch, std::vector<OutputStep> steps = {});

// Push constants of output_relax, output_bound and output_separate.
OutputRelaxPush relax_push(const Basis& basis, const OutputStep& step);
OutputBoundPush bound_push(const Basis& basis);
OutputSeparatePush separate_push(const Basis& basis, const OutputStep& step);

}  // namespace bodyopt
