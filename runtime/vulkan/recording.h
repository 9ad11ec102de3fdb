// What of a frame is recorded for a host program: into its command buffer, to its buffers.
#pragma once

#include "runtime/vulkan/functions.h"

namespace bodyopt::vulkan {

// Three numbers of each vertex, four of a tangent, in output order, bytes; strides and offset are multiples of 4.
struct PlacedOutput {
  VkBuffer buffer = VK_NULL_HANDLE;  // none: not wanted
  VkDeviceSize size = 0, offset = 0, element_stride = 0;
};

struct Recording {
  VkCommandBuffer commands = VK_NULL_HANDLE;
  PlacedOutput positions, normals, tangents;
};

}  // namespace bodyopt::vulkan
