#include "runtime/vulkan/kernels/block_down.h"

#include <array>

#include "block_down.spv.h"
#include "shaders/include/layout.h"

namespace bodyopt::vulkan {

BlockDown::BlockDown(const Device& device) : kernel_(device, block_down_spv, sizeof(BlockDownPush)) {}

void BlockDown::record(Commands& commands, const Buffers& buffers, const InverseBuffers::Level& level,
                       std::uint32_t right_side_count, std::uint32_t interleave) const {
  const InverseBuffers& inverse = buffers.inverse;
  for (const InverseWindow& window : level.down) {
    if (&window != &level.down.front()) commands.barrier();  // all windows write into one buffer
    const std::array bindings = {
        BufferRange(inverse.down), inverse.values_of(window), BufferRange(inverse.slot_unknown),
        buffers.results,           buffers.solutions,         buffers.solutions};
    const BlockDownPush push{window.first,       window.count,          window.first_value,
                             inverse.slot_count, inverse.unknown_count, interleave};
    commands.dispatch(kernel_, bindings, push, window.count * kWorkgroupSize, right_side_count);
  }
}

}  // namespace bodyopt::vulkan
