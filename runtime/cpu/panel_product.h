// The dense product of the block inverse: a panel's rows times a vector, as block_up and block_down need it.
#pragma once

#include "runtime/basis/block_inverse.h"

namespace bodyopt::cpu {

// Sums of kBlockSize rows; the order is that of kSumParts. input(c): what column c is multiplied with.
struct PanelSums {
  float rows[kBlockSize];
};

template <typename Input>
inline PanelSums panel_product(const InversePanel& panel, const float* values, const Input& input) {
  float parts[kSumParts][kBlockSize] = {};
  const float* column = values + panel.first_value;
  std::uint32_t c = 0;
  for (; c + kSumParts <= panel.input_count; c += kSumParts) {
    for (std::uint32_t part = 0; part < kSumParts; ++part, column += kBlockSize) {
      const float x = input(c + part);
      for (std::uint32_t row = 0; row < kBlockSize; ++row) parts[part][row] += column[row] * x;
    }
  }
  for (std::uint32_t part = 0; c < panel.input_count; ++c, ++part, column += kBlockSize) {
    const float x = input(c);
    for (std::uint32_t row = 0; row < kBlockSize; ++row) parts[part][row] += column[row] * x;
  }
  PanelSums sums;
  for (std::uint32_t row = 0; row < kBlockSize; ++row) {
    sums.rows[row] = (parts[0][row] + parts[1][row]) + (parts[2][row] + parts[3][row]);
  }
  return sums;
}

}  // namespace bodyopt::cpu
