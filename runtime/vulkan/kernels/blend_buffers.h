// Entries of a blend on the device: of the residual, or of the modifiers.
#pragma once

#include <vector>

#include "runtime/vulkan/kernels/block_windows.h"
#include "shaders/include/layout.h"

namespace bodyopt::vulkan {

struct BlendBuffers {
  // `limits`: as of block_windows. Throws Error(device).
  BlendBuffers(const Device& device, const std::vector<std::uint32_t>& begin, const std::vector<BlendEntry>& blend,
               const DeviceInfo& limits)
      : block_begin(upload_whole(device, begin, "the blend's blocks", limits)),
        entries(upload(device, blend, "the blend")),
        windows(block_windows({begin, sizeof(BlendEntry), 0, "the blend"}, limits)) {}

  BufferRange entries_of(const BlockWindow& window) const {
    return {entries, window.entries_offset, window.entries_size};
  }

  Buffer block_begin, entries;
  std::vector<BlockWindow> windows;
};

}  // namespace bodyopt::vulkan
