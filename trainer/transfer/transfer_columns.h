// The columns of a trained residual, carried to another skin.
#pragma once

#include "runtime/basis/basis.h"
#include "trainer/transfer/skin_transfer.h"

namespace bodyopt {

// How large each coefficient is: root mean square of what it is away from rest, over the poses that the regions' kernel
// centres are of. coefficient_count.
Eigen::VectorXd coefficient_sizes(const ResidualTable& residual);

// Replaces the blend of `residual`, which is that of the source, by the target's (`vertices` of them): every column is
// carried over, then packed. What a block has little of is left out, and what eight bits leave much of is packed twice,
// so that either costs at most `tolerance` metres, root mean square over the skin. Shows progress.
void transfer_columns(const SkinTransfer& transfer, std::uint32_t source_vertices, std::uint32_t vertices,
                      double tolerance, ResidualTable& residual);

}  // namespace bodyopt
