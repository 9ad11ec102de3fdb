// Tables on the device of which a kernel sees a window of blocks.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "runtime/basis/basis.h"
#include "runtime/basis/dynamics.h"
#include "runtime/vulkan/buffer.h"
#include "runtime/vulkan/commands.h"
#include "shaders/include/layout.h"

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

struct DdmBuffers {
  // `limits`: as of block_windows. Throws Error(device).
  DdmBuffers(Uploads& uploads, const DdmTable& ddm, const DeviceInfo& limits);

  BufferRange moments_of(const BlockWindow& window) const {
    return {moments, window.entries_offset, window.entries_size};
  }
  BufferRange vertices_of(const BlockWindow& window) const {
    return {vertices, window.vertices_offset, window.vertices_size};
  }

  Buffer block_begin, block_joints, moments, vertices;
  std::vector<BlockWindow> windows;
};

// The fan of every vertex on the device: the triangles around it. Fans are in the order of the vertices, so that a
// window of vertices sees a range of them.
struct FanBuffers {
  // `limits`: as of block_windows. Throws Error(device).
  FanBuffers(Uploads& uploads, const MeshTable& mesh, const DeviceInfo& limits);

  BufferRange triangles_of(const BlockWindow& window) const {
    return {triangles, window.entries_offset, window.entries_size};
  }

  Buffer begin, triangles;  // as vertex_triangle_begin; three corners of each triangle
  std::vector<BlockWindow> windows;
};

// Entries of a blend on the device: of the residual, or of the modifiers.
struct BlendBuffers {
  // `limits`: as of block_windows. Throws Error(device).
  BlendBuffers(Uploads& uploads, const std::vector<std::uint32_t>& begin, const std::vector<BlendEntry>& blend,
               const DeviceInfo& limits)
      : block_begin(upload_whole(uploads, begin, "the blend's blocks", limits)),
        entries(upload(uploads, blend, "the blend")),
        windows(block_windows({begin, sizeof(BlendEntry), 0, "the blend"}, limits)) {}

  BufferRange entries_of(const BlockWindow& window) const {
    return {entries, window.entries_offset, window.entries_size};
  }

  Buffer block_begin, entries;
  std::vector<BlockWindow> windows;
};

// A block inverse on the device, its values seen through windows where they are more than one binding can be.

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
  InverseBuffers(Uploads& uploads, const BlockInverse& inverse, const DeviceInfo& limits);

  BufferRange values_of(const InverseWindow& window) const;

  std::uint32_t unknown_count, slot_count;
  Buffer slot_unknown, child_slots, up, down, values;
  std::vector<LevelWindows> levels;  // leaves first
};

}  // namespace bodyopt::vulkan
