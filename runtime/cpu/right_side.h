// Where an unknown of one of many right sides stands (runtime/cpu/dynamics_kernels.h).
#pragma once

#include <cstddef>
#include <cstdint>

namespace bodyopt::cpu {

struct RightSide {
  RightSide(std::uint32_t number, std::uint32_t interleave, std::uint32_t unknown_count)
      : step(interleave), begin(std::size_t{number / interleave} * unknown_count * interleave + number % interleave) {}

  std::size_t operator()(std::uint32_t unknown) const { return begin + std::size_t{unknown} * step; }

  std::size_t step, begin;
};

}  // namespace bodyopt::cpu
