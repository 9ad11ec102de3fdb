#include "runtime/vulkan/kernels/block_up.h"

#include <array>

#include "block_up.spv.h"
#include "shaders/include/layout.h"

namespace bodyopt::vulkan {

BlockUp::BlockUp(const Device& device) : kernel_(device, block_up_spv, sizeof(BlockUpPush)) {}

void BlockUp::record(Commands& commands, const Buffers& buffers, const InverseBuffers::Level& level,
                     std::uint32_t right_side_count) const {
  const InverseBuffers& inverse = buffers.inverse;
  for (const InverseWindow& window : level.up) {
    if (&window != &level.up.front()) commands.barrier();  // all windows write into one buffer
    const std::array bindings = {BufferRange(inverse.up), inverse.values_of(window), buffers.gathered, buffers.results};
    const BlockUpPush push{window.first, window.count, window.first_value, level.slots.own_end, inverse.slot_count};
    commands.dispatch(kernel_, bindings, push, window.count * kWorkgroupSize, right_side_count);
  }
}

}  // namespace bodyopt::vulkan
