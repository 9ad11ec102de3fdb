// What moves the posed skin in the end, before its normals are found: relax, then push-out.
#pragma once

#include <vector>

#include "runtime/basis/basis.h"

namespace bodyopt {

// What output_relax and output_separate are pushed, step by step; nothing where the basis has no such modifier.
struct OutputSteps {
  std::vector<OutputRelaxPush> relax;
  std::vector<OutputSeparatePush> separate;

  bool empty() const { return relax.empty() && separate.empty(); }
};

OutputSteps output_steps(const Basis& basis);

}  // namespace bodyopt
