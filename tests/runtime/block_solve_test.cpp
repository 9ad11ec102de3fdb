#include <bit>

#include "runtime/core/error.h"
#include "runtime/cpu/dynamics_kernels.h"
#include "runtime/vulkan/backend/device_model.h"
#include "tests/support/gpu_fixture.h"
#include "tests/support/random_tables.h"
#include "tests/support/small_inverse.h"

namespace bodyopt::testing {
namespace {

// Solutions of unknowns that are nobody's are as before: 7.
constexpr float kBefore = 7;

struct Case {
  Case(std::uint32_t own, RightSides right_sides_)
      : random(own + 31 * right_sides_.count),
        sides(right_sides_),
        small(random, own),
        right_sides(random.floats(std::size_t{sides.count} * small.inverse.unknown_count, -1, 1)) {}

  std::vector<float> on_cpu() const {
    std::vector<float> scratch, solutions(right_sides.size(), kBefore);
    cpu::block_solve(small.inverse, right_sides, sides.count, sides.interleave, scratch, solutions);
    return solutions;
  }

  std::vector<float> on_gpu(const vulkan::Device& device, const vulkan::DeviceInfo& limits) const {
    const vulkan::BlockSolve solve(device);
    const auto inverse = vulkan::upload_together<vulkan::InverseBuffers>(device, small.inverse, limits);
    const auto b = vulkan::upload(device, right_sides, "right sides");
    const VkDeviceSize scratch = sizeof(float) * sides.count * VkDeviceSize{small.inverse.slot_count()};
    const vulkan::Buffer gathered(device, scratch, vulkan::Memory::device, "gathered"),
        results(device, scratch, vulkan::Memory::device, "results");
    return run_kernel(device, {right_sides.size()}, [&](auto& commands, const auto& out) {
      commands.fill(out[0], std::bit_cast<std::uint32_t>(kBefore));
      solve.record(commands, {inverse, b, gathered, results, out[0]}, sides.count, sides.interleave);
    })[0];
  }

  Random random;
  RightSides sides;
  SmallInverse small;
  std::vector<float> right_sides;
};

class BlockSolve : public GpuTest {};

TEST_F(BlockSolve, EqualsTheReference) {
  for (const std::uint32_t own : kFrontSizes) {
    for (const RightSides sides : kRightSides) {
      SCOPED_TRACE(std::to_string(own) + " unknowns a front, " + std::to_string(sides.count) + " right sides");
      const Case c(own, sides);
      expect_close(c.on_gpu(*device_, device_->info()), c.on_cpu(), 0);
    }
  }
}

TEST_F(BlockSolve, ReferenceSolvesTheSystem) {
  for (const std::uint32_t own : kFrontSizes) {
    const Case c(own, {6, 3});
    const std::vector<float> solutions = c.on_cpu();
    const std::size_t count = c.small.inverse.unknown_count;
    for (std::size_t r = 0; r < c.sides.count; ++r) {
      Eigen::VectorXd x(count), b(count);
      for (std::size_t q = 0; q < count; ++q) {
        const auto k = static_cast<Eigen::Index>(q);
        const std::size_t at = place_of(c.small.inverse, c.sides, r, q);
        const bool nobodys = c.small.matrix(k, k) == 0;
        x[k] = static_cast<double>(solutions[at]);
        b[k] = nobodys ? 0 : static_cast<double>(c.right_sides[at]);
        EXPECT_EQ(nobodys, solutions[at] == kBefore);
      }
      EXPECT_LE((c.small.matrix * x - b).norm(), 1e-5 * b.norm()) << own << " unknowns a front";
    }
  }
}

// Of windows over panels, or strips: that they follow one another, are aligned, fit, and have all values.
template <typename Panel, typename EndValue>
void expect_windows(const std::vector<Panel>& panels, const vulkan::DeviceInfo& limits, const EndValue& end_value) {
  const auto windows = vulkan::inverse_windows(panels, 0, static_cast<std::uint32_t>(panels.size()), limits);
  EXPECT_GT(windows.size(), 3u);
  std::size_t next = 0;
  for (const vulkan::InverseWindow& window : windows) {
    EXPECT_EQ(window.first, next);
    EXPECT_EQ(window.first_value * sizeof(float) % limits.storage_alignment, 0u);
    EXPECT_LE((window.end_value - window.first_value) * sizeof(float), limits.max_storage_buffer_range);
    for (const std::size_t end = next + window.count; next < end; ++next) {
      if (panels[next].input_count == 0) continue;
      EXPECT_GE(panels[next].first_value, window.first_value);
      EXPECT_LE(end_value(panels[next]), window.end_value);
    }
  }
  EXPECT_EQ(next, panels.size());
}

// A device whose bindings see little: the values are seen through windows, of unaligned panels too.
TEST_F(BlockSolve, WindowsGiveTheSameBits) {
  const Case c(90, {3, 3});
  const std::vector<float> whole = c.on_gpu(*device_, device_->info());
  std::uint64_t longest = 0;                              // of a strip
  const auto strip_end = [](const InverseStrip& strip) {  // of the last row's last panel
    const std::uint32_t panels = (strip.input_count + kBlockSize - 1) / kBlockSize;
    return strip.first_value + (panels - 1) * strip.panel_step + strip.row_count * kBlockSize;
  };
  for (const InverseStrip& strip : c.small.inverse.down) {
    if (strip.input_count > 0) longest = std::max<std::uint64_t>(longest, 4 * (strip_end(strip) - strip.first_value));
  }
  vulkan::DeviceInfo limits = device_->info();
  limits.storage_alignment = 256;
  for (const std::uint64_t range : {longest + 256, longest + 20000}) {
    limits.max_storage_buffer_range = range;
    expect_windows(c.small.inverse.up, limits,
                   [](const InversePanel& panel) { return panel.first_value + panel.input_count * kBlockSize; });
    expect_windows(c.small.inverse.down, limits, strip_end);
    EXPECT_EQ(c.on_gpu(*device_, limits), whole) << "range " << range;
  }
  limits.max_storage_buffer_range = 400;  // less than one panel
  EXPECT_THROW(c.on_gpu(*device_, limits), Error);
  limits = device_->info();
  limits.max_groups_x = 3;
  EXPECT_EQ(c.on_gpu(*device_, limits), whole);
}

}  // namespace
}  // namespace bodyopt::testing
