// A column of the residual's blend in one block, in eight bits a number.
#pragma once

#include <Eigen/Core>

#include "runtime/basis/basis.h"

namespace bodyopt {

// A column's vectors at the lanes of a block.
using BlockVectors = Eigen::Matrix<double, 3, kBlockSize>;

struct PackedEntry {
  BlendEntry entry;
  BlockVectors left;  // what it differs by
};

PackedEntry pack_entry(const BlockVectors& vectors, std::uint32_t coefficient);

}  // namespace bodyopt
