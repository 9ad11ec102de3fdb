// Tables by blocks of vertices, seen through windows where they are larger than one binding can be.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "runtime/vulkan/buffer.h"

namespace bodyopt::vulkan {

// A range of blocks whose entries fit one binding.
struct BlockWindow {
  std::uint32_t first_vertex, end_vertex;       // lanes of the table
  std::uint32_t first_entry;                    // entry at which the bound ones begin
  VkDeviceSize entries_offset, entries_size;    // bytes
  VkDeviceSize vertices_offset, vertices_size;  // bytes of a table with a record of each lane
};

struct BlockTable {
  std::span<const std::uint32_t> block_begin;  // entry at which each block's begin, and the end
  VkDeviceSize entry_bytes, vertex_bytes;      // of an entry; of a lane's record
  const char* name;
};

// Windows over all blocks. `limits`: storage range, offset alignment and groups of the device. Throws Error(device)
// when a single block is larger than one binding.
std::vector<BlockWindow> block_windows(const BlockTable& table, const DeviceInfo& limits);

}  // namespace bodyopt::vulkan
