// Finds the joints that hold each part of the skin, by the omegas of Direct Delta Mush.
#pragma once

#include <bit>

#include "runtime/basis/basis.h"

namespace bodyopt {

// Calls use(joint, omega) for every joint of the vertex' block; omega is 0 where the joint does not hold the vertex.
template <typename Use>
void for_each_omega(const DdmTable& ddm, std::uint32_t vertex, const Use& use) {
  const std::uint32_t block = vertex / kBlockSize, lane = vertex % kBlockSize;
  for (std::uint32_t e = ddm.block_begin[block]; e < ddm.block_begin[block + 1]; ++e) {
    const std::uint32_t omega = ddm.moments[(std::size_t{e} * kMomentWords + kMomentWords - 1) * kBlockSize + lane];
    use(ddm.block_joints[e], double{std::bit_cast<float>(omega)});
  }
}

}  // namespace bodyopt
