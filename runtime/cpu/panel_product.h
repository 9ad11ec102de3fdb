// The dense products of the block inverse, on the way up (rows of panels) and down (the same numbers by columns). Made
// for wider registers, too, which the processor chooses when the program starts: all give the same bits.
#pragma once

#include "runtime/basis/block_inverse.h"

namespace bodyopt::cpu {

// Sums of a panel's rows, in the order of kSumParts. inputs: of every column.
void panel_product(const InversePanel& panel, const float* values, const float* inputs, float (&sums)[kBlockSize]);

// Sums of a strip's rows, in the order said at kSumParts. inputs: at its boundary slots, up to the next multiple of
// kBlockSize (with zeros).
void strip_product(const InverseStrip& strip, const float* values, const float* inputs, float (&sums)[kBlockSize]);

// Multiply-adds of panels, or strips, [begin, end).
template <typename Panel>
std::size_t work_of(const std::vector<Panel>& panels, std::uint32_t begin, std::uint32_t end) {
  std::size_t work = 0;
  for (std::uint32_t p = begin; p < end; ++p) work += std::size_t{panels[p].row_count} * panels[p].input_count;
  return work;
}

}  // namespace bodyopt::cpu
