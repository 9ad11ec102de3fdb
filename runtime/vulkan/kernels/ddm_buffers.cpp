#include "runtime/vulkan/kernels/ddm_buffers.h"

#include <algorithm>
#include <numeric>

#include "runtime/core/error.h"

namespace bodyopt::vulkan {
namespace {

constexpr std::uint64_t kEntryBytes = std::uint64_t{kMomentWords} * kBlockSize * sizeof(std::uint32_t);
constexpr std::uint64_t kBlockVertexBytes = kBlockSize * sizeof(DdmVertex);

// The window of blocks [first, end).
DdmWindow make_window(const DdmTable& ddm, std::uint32_t first, std::uint32_t end, std::uint64_t alignment) {
  DdmWindow window{};
  window.first_vertex = first * kBlockSize;
  window.end_vertex = end * kBlockSize;
  // Offsets of bindings are aligned, entries need not be: begin at an earlier entry that is.
  const auto step = static_cast<std::uint32_t>(std::lcm(kEntryBytes, alignment) / kEntryBytes);
  window.first_entry = ddm.block_begin[first] / step * step;
  window.moments_offset = window.first_entry * kEntryBytes;
  window.moments_size = std::max(kEntryBytes, (ddm.block_begin[end] - window.first_entry) * kEntryBytes);
  window.vertices_offset = first * kBlockVertexBytes;
  window.vertices_size = (end - first) * kBlockVertexBytes;
  return window;
}

}  // namespace

std::vector<DdmWindow> ddm_windows(const DdmTable& ddm, const DeviceInfo& limits) {
  const std::uint64_t alignment = std::max<std::uint64_t>(1, limits.storage_alignment);
  const auto blocks = static_cast<std::uint32_t>(ddm.block_begin.empty() ? 0 : ddm.block_begin.size() - 1);
  const std::uint64_t most_vertices = std::uint64_t{limits.max_groups_x} * kWorkgroupSize;
  // Vertices begin at multiples of 512 bytes, which every alignment that Vulkan allows (at most 256) divides.
  const auto fits = [&](const DdmWindow& w) {
    return std::max(w.moments_size, w.vertices_size) <= limits.max_storage_buffer_range &&
           w.end_vertex - w.first_vertex <= most_vertices;
  };
  std::vector<DdmWindow> windows;
  for (std::uint32_t first = 0; first < blocks;) {
    // The largest end that fits, by bisection.
    std::uint32_t low = first, high = blocks;
    while (low < high) {
      const std::uint32_t middle = high - (high - low) / 2;
      if (fits(make_window(ddm, first, middle, alignment))) {
        low = middle;
      } else {
        high = middle - 1;
      }
    }
    if (low == first) {
      throw Error(ErrorKind::device, "one block of the DDM table is larger than the " +
                                         std::to_string(limits.max_storage_buffer_range) +
                                         " bytes that a binding of '" + limits.name + "' can see");
    }
    windows.push_back(make_window(ddm, first, low, alignment));
    first = low;
  }
  return windows;
}

DdmBuffers::DdmBuffers(const Device& device, const DdmTable& ddm, const DeviceInfo& limits)
    : block_begin(upload(device, ddm.block_begin, "the DDM blocks")),
      block_joints(upload(device, ddm.block_joints, "the DDM joints")),
      moments(upload(device, ddm.moments, "the DDM moments")),
      vertices(upload(device, ddm.vertices, "the DDM vertices")),
      windows(ddm_windows(ddm, limits)) {}

}  // namespace bodyopt::vulkan
