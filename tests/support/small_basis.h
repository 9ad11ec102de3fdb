// A small valid basis with every table filled: a capped cylinder along y on two joints, with a bend in the middle, two
// fibres, one control and a residual of two regions. The same every time.
#pragma once

#include "runtime/basis/basis.h"

namespace bodyopt::testing {

Basis small_basis();

// The small basis, its first region without kernel centres, the second with three or so, as one that knows its error.
Basis knowing_basis();

}  // namespace bodyopt::testing
