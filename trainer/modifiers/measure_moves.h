// How far each modifier moves the skin.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "runtime/basis/basis.h"

namespace bodyopt {

// Of a modifier that is switched on, over some poses.
struct ModifierMove {
  std::string modifier;
  double largest = 0;    // metres, of one vertex, beside the skin without this modifier alone
  std::size_t pose = 0;  // in which it is
};

// In the stack's order. `poses` have the weights of the basis' modifiers (drive_modifiers). The skin is quasi-static.
std::vector<ModifierMove> measure_moves(const Basis& basis, std::span<const Pose> poses);

}  // namespace bodyopt
