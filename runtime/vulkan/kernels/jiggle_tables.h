// Tables of the jiggle as its kernels bind them: in fewer buffers than the file has arrays.
#pragma once

#include <vector>

#include "runtime/basis/dynamics.h"

namespace bodyopt::vulkan {

std::vector<NodeRows> node_rows(const TetTable& tets, const JiggleTable& jiggle);
std::vector<HeldNode> held_nodes(const JiggleTable& jiggle);

}  // namespace bodyopt::vulkan
