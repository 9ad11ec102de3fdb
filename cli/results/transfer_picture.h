// A picture of which point of one skin is which of another.
#pragma once

#include "draw/renderer.h"
#include "trainer/transfer/transfer_pair.h"

namespace bodyopt::cli {

// The source, coloured by place; the target, each point in the colour of its match; the target again, from clay where
// the match is sure to hot where it is not. Both in the common pose, each as large as the other.
// Throws Error(device).
Image transfer_picture(const TransferPair& pair);

}  // namespace bodyopt::cli
