#include "runtime/vulkan/kernels/block_buffers.h"

#include <algorithm>
#include <numeric>

#include "runtime/core/error.h"

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

constexpr VkDeviceSize kEntryBytes = VkDeviceSize{kMomentWords} * kBlockSize * sizeof(std::uint32_t);

// Three corners of every triangle around every vertex.
std::vector<std::uint32_t> fans_of(const MeshTable& mesh) {
  std::vector<std::uint32_t> fans;
  fans.reserve(3 * mesh.vertex_triangles.size());
  for (const std::uint32_t triangle : mesh.vertex_triangles) {
    const std::uint32_t* corners = mesh.triangles.data() + 3 * std::size_t{triangle};
    fans.insert(fans.end(), corners, corners + 3);
  }
  return fans;
}

// Returns where the fans of every block of vertices begin, and the end.
std::vector<std::uint32_t> block_begin(const MeshTable& mesh) {
  const std::uint32_t vertices = mesh.vertex_count();
  std::vector<std::uint32_t> begin;
  for (std::uint32_t v = 0; v < vertices; v += kBlockSize) begin.push_back(mesh.vertex_triangle_begin[v]);
  begin.push_back(mesh.vertex_triangle_begin.back());
  return begin;
}

// Adds the panel that follows the window's last; false, and the window as it was, where it does not fit.
template <typename Panel>
bool add_panel(InverseWindow& window, const Panel& panel, const DeviceInfo& limits) {
  if (window.count == limits.max_groups_x) return false;
  if (panel.input_count > 0) {
    // Offsets of bindings are aligned, panels need not be: begin at an earlier value that is.
    const auto step = static_cast<std::uint32_t>(std::max<std::uint64_t>(1, limits.storage_alignment / sizeof(float)));
    std::uint32_t first = panel.first_value / step * step;
    std::uint64_t end = end_value(panel);
    if (window.end_value > 0) {
      first = std::min(first, window.first_value);
      end = std::max(end, window.end_value);
    }
    if ((end - first) * sizeof(float) > limits.max_storage_buffer_range) return false;
    window.first_value = first;
    window.end_value = end;
  }
  ++window.count;
  return true;
}

template <typename Panel>
std::vector<InverseWindow> windows_over(const std::vector<Panel>& panels, std::uint32_t begin, std::uint32_t end,
                                        const DeviceInfo& limits) {
  std::vector<InverseWindow> windows;
  for (std::uint32_t p = begin; p < end; ++p) {
    if (!windows.empty() && add_panel(windows.back(), panels[p], limits)) continue;
    windows.push_back({p, 0, 0, 0});
    if (add_panel(windows.back(), panels[p], limits)) continue;
    throw Error(ErrorKind::device, (end_value(panels[p]) - panels[p].first_value) * sizeof(float),
                " bytes of a block inverse that are needed together are more than the ",
                limits.max_storage_buffer_range, " bytes that a binding of '", limits.name, "' can see");
  }
  return windows;
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

DdmBuffers::DdmBuffers(Uploads& uploads, const DdmTable& ddm, const DeviceInfo& limits)
    : block_begin(upload_whole(uploads, ddm.block_begin, "the DDM blocks", limits)),
      block_joints(upload_whole(uploads, ddm.block_joints, "the DDM joints", limits)),
      moments(upload(uploads, ddm.moments, "the DDM moments")),
      vertices(upload(uploads, ddm.vertices, "the DDM vertices")),
      windows(block_windows({ddm.block_begin, kEntryBytes, sizeof(DdmVertex), "the DDM table"}, limits)) {}

FanBuffers::FanBuffers(Uploads& uploads, const MeshTable& mesh, const DeviceInfo& limits)
    : begin(upload_whole(uploads, mesh.vertex_triangle_begin, "the vertices' fans", limits)),
      triangles(upload(uploads, fans_of(mesh), "the triangles around vertices")),
      windows(
          block_windows({block_begin(mesh), 3 * sizeof(std::uint32_t), 0, "the triangles around vertices"}, limits)) {}

std::vector<InverseWindow> inverse_windows(const std::vector<InversePanel>& panels, std::uint32_t begin,
                                           std::uint32_t end, const DeviceInfo& limits) {
  return windows_over(panels, begin, end, limits);
}

std::vector<InverseWindow> inverse_windows(const std::vector<InverseStrip>& strips, std::uint32_t begin,
                                           std::uint32_t end, const DeviceInfo& limits) {
  return windows_over(strips, begin, end, limits);
}

InverseBuffers::InverseBuffers(Uploads& uploads, const BlockInverse& inverse, const DeviceInfo& limits)
    : unknown_count(inverse.unknown_count),
      slot_count(inverse.slot_count()),
      slot_unknown(upload_whole(uploads, inverse.slot_unknown, "the block inverse's unknowns", limits)),
      child_slots(upload_whole(uploads, inverse.child_slots, "the block inverse's children", limits)),
      up(upload_whole(uploads, inverse.up, "the block inverse's panels", limits)),
      down(upload_whole(uploads, inverse.down, "the block inverse's strips", limits)),
      values(upload(uploads, inverse.values, "the block inverse's values")) {
  for (const InverseLevel& level : inverse.levels) {
    levels.push_back({level, inverse_windows(inverse.up, level.up_begin, level.up_end, limits),
                      inverse_windows(inverse.down, level.down_begin, level.down_end, limits)});
  }
}

BufferRange InverseBuffers::values_of(const InverseWindow& window) const {
  if (window.end_value == 0) return {values, 0, kBlockSize};  // something must be bound
  return {values, window.first_value * VkDeviceSize{sizeof(float)},
          (window.end_value - window.first_value) * sizeof(float)};
}

}  // namespace bodyopt::vulkan
