// What moves the posed skin in the end, before its normals are found: relax, then push-out.
#pragma once

#include <vector>

#include "runtime/host/backend.h"

namespace bodyopt {

// What output_relax and output_separate are pushed, step by step; nothing where the basis has no such modifier, or no
// frame of the batch a weight for it.
struct OutputSteps {
  std::vector<OutputRelaxPush> relax;
  std::vector<OutputSeparatePush> separate;
};

OutputSteps output_steps(const Basis& basis, const Batch& batch);

}  // namespace bodyopt
