// The DDM table on the device, seen through windows where it is larger than one binding can be.
#pragma once

#include <vector>

#include "runtime/basis/basis.h"
#include "runtime/vulkan/commands.h"

namespace bodyopt::vulkan {

// A range of blocks whose moments and vertices each fit one binding.
struct DdmWindow {
  std::uint32_t first_vertex, end_vertex;       // lanes of the table
  std::uint32_t first_entry;                    // entry at which the bound moments begin
  VkDeviceSize moments_offset, moments_size;    // bytes
  VkDeviceSize vertices_offset, vertices_size;  // bytes
};

// Windows over all blocks. `limits`: storage range, offset alignment and groups of the device. Throws Error(device)
// when a single block is larger than one binding.
std::vector<DdmWindow> ddm_windows(const DdmTable& ddm, const DeviceInfo& limits);

struct DdmBuffers {
  // Throws Error(device).
  DdmBuffers(const Device& device, const DdmTable& ddm, const DeviceInfo& limits);

  Buffer block_begin, block_joints, moments, vertices;
  std::vector<DdmWindow> windows;
};

}  // namespace bodyopt::vulkan
