// The unit that a basis' character was read with, kept in the basis so that its clips and meshes are read alike.
#pragma once

#include "runtime/basis/basis.h"

namespace bodyopt {

// Metres per unit of the character's file; 0: it is in metres.
void keep_unit(Basis& basis, double unit);
// Throws Error(file) where what is kept is no unit.
double kept_unit(const Basis& basis);

}  // namespace bodyopt
