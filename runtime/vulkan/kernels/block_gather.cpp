#include "runtime/vulkan/kernels/block_gather.h"

#include <array>

#include "block_gather.spv.h"
#include "shaders/include/layout.h"

namespace bodyopt::vulkan {

BlockGather::BlockGather(const Device& device) : kernel_(device, block_gather_spv, sizeof(BlockGatherPush)) {}

void BlockGather::record(Commands& commands, const Buffers& buffers, const InverseBuffers::Level& level,
                         std::uint32_t right_side_count, std::uint32_t interleave) const {
  const InverseBuffers& inverse = buffers.inverse;
  const std::array bindings = {BufferRange(inverse.slot_unknown), BufferRange(inverse.child_slots), buffers.right_sides,
                               buffers.results, buffers.gathered};
  const InverseLevel& slots = level.slots;
  const BlockGatherPush push{slots.first_slot,   slots.own_end,         slots.end_slot,
                             inverse.slot_count, inverse.unknown_count, interleave};
  commands.dispatch(kernel_, bindings, push, slots.end_slot - slots.first_slot, right_side_count);
}

}  // namespace bodyopt::vulkan
