// The dense product of the block inverse: a panel's rows times a vector, as block_up and block_down need it.
#pragma once

#include <cstring>

#include "runtime/basis/block_inverse.h"

namespace bodyopt::cpu {

// A number per row of a panel, which the compiler keeps in vector registers.
using PanelRows = float __attribute__((vector_size(kBlockSize * sizeof(float))));

// Sums of a panel's rows, in the order of kSumParts. input(c): what column c is multiplied with.
template <typename Input>
inline PanelRows panel_product(const InversePanel& panel, const float* values, const Input& input) {
  static_assert(kSumParts == 4);
  const float* from = values + panel.first_value;
  const auto column = [&](std::uint32_t c) {
    PanelRows numbers;
    std::memcpy(&numbers, from + std::size_t{c} * kBlockSize, sizeof numbers);
    return numbers;
  };
  PanelRows parts[kSumParts] = {};
  const std::uint32_t whole = panel.input_count - panel.input_count % kSumParts;
  for (std::uint32_t c = 0; c < whole; c += kSumParts) {
    parts[0] += column(c) * input(c);
    parts[1] += column(c + 1) * input(c + 1);
    parts[2] += column(c + 2) * input(c + 2);
    parts[3] += column(c + 3) * input(c + 3);
  }
  for (std::uint32_t c = whole; c < panel.input_count; ++c) parts[c - whole] += column(c) * input(c);
  return (parts[0] + parts[1]) + (parts[2] + parts[3]);
}

}  // namespace bodyopt::cpu
