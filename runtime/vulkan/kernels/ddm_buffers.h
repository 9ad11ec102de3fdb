// The DDM table on the device.
#pragma once

#include <vector>

#include "runtime/basis/basis.h"
#include "runtime/vulkan/kernels/block_windows.h"

namespace bodyopt::vulkan {

struct DdmBuffers {
  // `limits`: as of block_windows. Throws Error(device).
  DdmBuffers(const Device& device, const DdmTable& ddm, const DeviceInfo& limits);

  BufferRange moments_of(const BlockWindow& window) const {
    return {moments, window.entries_offset, window.entries_size};
  }
  BufferRange vertices_of(const BlockWindow& window) const {
    return {vertices, window.vertices_offset, window.vertices_size};
  }

  Buffer block_begin, block_joints, moments, vertices;
  std::vector<BlockWindow> windows;
};

}  // namespace bodyopt::vulkan
