// A block inverse on the device, its values seen through windows where they are more than one binding can be.
#pragma once

#include <vector>

#include "runtime/basis/block_inverse.h"
#include "runtime/vulkan/commands.h"

namespace bodyopt::vulkan {

// Consecutive panels, or strips, whose values fit one binding.
struct InverseWindow {
  std::uint32_t first, count;  // panels or strips
  std::uint32_t first_value;   // value at which the bound values begin
  std::uint64_t end_value;     // 0: they have no values
};

// Windows over panels, or strips, [begin, end). `limits`: storage range, offset alignment and groups of the device.
// Throws Error(device) when a single one reaches over more than one binding.
std::vector<InverseWindow> inverse_windows(const std::vector<InversePanel>& panels, std::uint32_t begin,
                                           std::uint32_t end, const DeviceInfo& limits);
std::vector<InverseWindow> inverse_windows(const std::vector<InverseStrip>& strips, std::uint32_t begin,
                                           std::uint32_t end, const DeviceInfo& limits);

struct InverseBuffers {
  struct LevelWindows {
    InverseLevel slots;
    std::vector<InverseWindow> up, down;
  };

  // Throws Error(device).
  InverseBuffers(const Device& device, const BlockInverse& inverse, const DeviceInfo& limits);

  BufferRange values_of(const InverseWindow& window) const;

  std::uint32_t unknown_count, slot_count;
  Buffer slot_unknown, child_slots, up, down, values;
  std::vector<LevelWindows> levels;  // leaves first
};

}  // namespace bodyopt::vulkan
