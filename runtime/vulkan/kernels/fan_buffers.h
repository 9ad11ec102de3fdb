// The fan of every vertex on the device: the triangles around it, one vertex after the other, so that a window of
// vertices sees a range of them.
#pragma once

#include <vector>

#include "runtime/basis/basis.h"
#include "runtime/vulkan/kernels/block_windows.h"

namespace bodyopt::vulkan {

struct FanBuffers {
  // `limits`: as of block_windows. Throws Error(device).
  FanBuffers(const Device& device, const MeshTable& mesh, const DeviceInfo& limits);

  BufferRange triangles_of(const BlockWindow& window) const {
    return {triangles, window.entries_offset, window.entries_size};
  }

  Buffer begin, triangles;  // as vertex_triangle_begin; three corners of each triangle
  std::vector<BlockWindow> windows;
};

}  // namespace bodyopt::vulkan
