// When a loop of the jiggle is worth more threads than one.
#pragma once

#include <cstddef>

namespace bodyopt::cpu {

// Multiply-adds, or as much. Below it threads wait for each other longer than they save; on a machine that does other
// work, too, waiting costs a hundred times as much.
constexpr std::size_t kParallelWork = std::size_t{1} << 18;

}  // namespace bodyopt::cpu
