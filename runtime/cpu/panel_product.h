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

}  // namespace bodyopt::cpu
