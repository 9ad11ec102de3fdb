#include "runtime/vulkan/kernels/block_windows.h"

#include <algorithm>
#include <numeric>

#include "runtime/core/error.h"
#include "shaders/include/layout.h"

namespace bodyopt::vulkan {
namespace {

// The window of blocks [first, end).
BlockWindow make_window(const BlockTable& table, std::uint32_t first, std::uint32_t end, std::uint64_t alignment) {
  BlockWindow window{};
  window.first_vertex = first * kBlockSize;
  window.end_vertex = end * kBlockSize;
  // Offsets of bindings are aligned, entries need not be: begin at an earlier entry that is.
  const auto step = static_cast<std::uint32_t>(std::lcm(table.entry_bytes, alignment) / table.entry_bytes);
  window.first_entry = table.block_begin[first] / step * step;
  window.entries_size = (table.block_begin[end] - window.first_entry) * table.entry_bytes;
  if (window.entries_size > 0) {
    window.entries_offset = window.first_entry * table.entry_bytes;
  } else {
    window.entries_size = sizeof(std::uint32_t);  // something must be bound
  }
  window.vertices_offset = window.first_vertex * table.vertex_bytes;
  window.vertices_size = (window.end_vertex - window.first_vertex) * table.vertex_bytes;
  return window;
}

}  // namespace

std::vector<BlockWindow> block_windows(const BlockTable& table, const DeviceInfo& limits) {
  const std::uint64_t alignment = std::max<std::uint64_t>(1, limits.storage_alignment);
  const auto blocks = static_cast<std::uint32_t>(table.block_begin.empty() ? 0 : table.block_begin.size() - 1);
  const std::uint64_t most_vertices = std::uint64_t{limits.max_groups_x} * kWorkgroupSize;
  // Records of 16 bytes or more begin at multiples of 256 bytes, which every alignment that Vulkan allows divides.
  const auto fits = [&](const BlockWindow& w) {
    return std::max(w.entries_size, w.vertices_size) <= limits.max_storage_buffer_range &&
           w.end_vertex - w.first_vertex <= most_vertices;
  };
  std::vector<BlockWindow> windows;
  for (std::uint32_t first = 0; first < blocks;) {
    // The largest end that fits, by bisection.
    std::uint32_t low = first, high = blocks;
    while (low < high) {
      const std::uint32_t middle = high - (high - low) / 2;
      if (fits(make_window(table, first, middle, alignment))) {
        low = middle;
      } else {
        high = middle - 1;
      }
    }
    if (low == first) {
      throw Error(ErrorKind::device, "one block of ", table.name, " is larger than the ",
                  limits.max_storage_buffer_range, " bytes that a binding of '", limits.name, "' can see");
    }
    windows.push_back(make_window(table, first, low, alignment));
    first = low;
  }
  return windows;
}

}  // namespace bodyopt::vulkan
