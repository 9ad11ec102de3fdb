// A picture of which point of one skin is which of another.
#pragma once

#include <filesystem>

#include "trainer/transfer/transfer_pair.h"

namespace bodyopt::cli {

// The source, coloured by place; the target, each point in the colour of its match; the target again, from clay where
// the match is sure to hot where it is not. Both in the common pose. Throws Error(device), Error(file).
void write_transfer_picture(const TransferPair& pair, const std::filesystem::path& path);

}  // namespace bodyopt::cli
