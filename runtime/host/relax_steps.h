// How relax is run.
#pragma once

#include <vector>

#include "runtime/host/backend.h"

namespace bodyopt {

// What output_relax is pushed, step by step; nothing where the basis has no such modifier, or no frame of the batch a
// weight for it.
std::vector<OutputRelaxPush> relax_steps(const Basis& basis, const Batch& batch);

}  // namespace bodyopt
