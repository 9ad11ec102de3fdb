#include "tests/support/small_windows.h"

#include <algorithm>
#include <string>

#include "runtime/core/error.h"
#include "shaders/include/layout.h"

namespace bodyopt::testing {

void expect_same_bits_through_windows(
    const vulkan::DeviceInfo& device, std::uint32_t vertices, const std::vector<std::uint64_t>& ranges,
    const std::function<std::vector<vulkan::BlockWindow>(const vulkan::DeviceInfo&)>& windows_of,
    const std::function<std::vector<float>(const vulkan::DeviceInfo&)>& run) {
  const std::vector<float> whole = run(device);
  vulkan::DeviceInfo limits = device;
  limits.storage_alignment = 256;
  for (const std::uint64_t range : ranges) {
    SCOPED_TRACE("range " + std::to_string(range));
    limits.max_storage_buffer_range = range;
    const std::vector<vulkan::BlockWindow> windows = windows_of(limits);
    ASSERT_GT(windows.size(), 1u);
    EXPECT_GE(windows.back().end_vertex, vertices);
    for (std::size_t w = 0; w < windows.size(); ++w) {
      EXPECT_LE(std::max(windows[w].entries_size, windows[w].vertices_size), range);
      EXPECT_EQ(windows[w].entries_offset % 256, 0u);
      EXPECT_EQ(windows[w].vertices_offset % 256, 0u);
      EXPECT_EQ(windows[w].first_vertex, w == 0 ? 0 : windows[w - 1].end_vertex);
    }
    EXPECT_EQ(run(limits), whole);
  }
  limits = device;
  limits.max_groups_x = 3;
  for (const vulkan::BlockWindow& window : windows_of(limits)) {
    EXPECT_LE(window.end_vertex - window.first_vertex, 3 * kWorkgroupSize);
  }
  EXPECT_EQ(run(limits), whole);
  limits.max_storage_buffer_range = 400;
  EXPECT_THROW(windows_of(limits), Error);
}

}  // namespace bodyopt::testing
