// How push-out is run.
#pragma once

#include <vector>

#include "runtime/basis/basis.h"

namespace bodyopt {

// What output_separate is pushed, step by step; nothing for a basis without push-out.
std::vector<OutputSeparatePush> separate_steps(const Basis& basis);

}  // namespace bodyopt
