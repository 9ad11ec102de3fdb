#include "runtime/vulkan/kernels/inverse_buffers.h"

#include <algorithm>

#include "runtime/core/error.h"

namespace bodyopt::vulkan {
namespace {

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

std::vector<InverseWindow> inverse_windows(const std::vector<InversePanel>& panels, std::uint32_t begin,
                                           std::uint32_t end, const DeviceInfo& limits) {
  return windows_over(panels, begin, end, limits);
}

std::vector<InverseWindow> inverse_windows(const std::vector<InverseStrip>& strips, std::uint32_t begin,
                                           std::uint32_t end, const DeviceInfo& limits) {
  return windows_over(strips, begin, end, limits);
}

InverseBuffers::InverseBuffers(const Device& device, const BlockInverse& inverse, const DeviceInfo& limits)
    : unknown_count(inverse.unknown_count),
      slot_count(inverse.slot_count()),
      slot_unknown(upload_whole(device, inverse.slot_unknown, "the block inverse's unknowns", limits)),
      child_slots(upload_whole(device, inverse.child_slots, "the block inverse's children", limits)),
      up(upload_whole(device, inverse.up, "the block inverse's panels", limits)),
      down(upload_whole(device, inverse.down, "the block inverse's strips", limits)),
      values(upload(device, inverse.values, "the block inverse's values")) {
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
