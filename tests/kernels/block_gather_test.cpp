#include "runtime/cpu/dynamics_kernels.h"
#include "runtime/vulkan/kernels/windows.h"
#include "tests/support/gpu_fixture.h"
#include "tests/support/small_inverse.h"

namespace bodyopt::testing {
namespace block_gather_test {

struct Case {
  Case(std::uint32_t own, RightSides right_sides_)
      : random(own + 31 * right_sides_.count),
        sides(right_sides_),
        small(random, own),
        right_sides(random.floats(std::size_t{sides.count} * small.inverse.unknown_count, -1, 1)),
        results(random.floats(std::size_t{sides.count} * small.inverse.slot_count(), -1, 1)),
        before(random.floats(results.size(), -1, 1)) {}

  std::vector<float> on_cpu(const InverseLevel& level) const {
    std::vector<float> gathered = before;
    cpu::block_gather(small.inverse, level, right_sides, sides.count, sides.interleave, results, gathered);
    return gathered;
  }

  Random random;
  RightSides sides;
  SmallInverse small;
  std::vector<float> right_sides, results, before;
};

class BlockGather : public GpuTest {};

TEST_F(BlockGather, EqualsTheReference) {
  const vulkan::BlockGather kernel(*device_);
  for (const std::uint32_t own : kFrontSizes) {
    for (const RightSides sides : kRightSides) {
      SCOPED_TRACE(std::to_string(own) + " unknowns a front, " + std::to_string(sides.count) + " right sides");
      const Case c(own, sides);
      const vulkan::InverseBuffers inverse(*device_, c.small.inverse, device_->info());
      const auto right_sides = vulkan::upload(*device_, c.right_sides, "right sides"),
                 results = vulkan::upload(*device_, c.results, "results"),
                 before = vulkan::upload(*device_, c.before, "before");
      for (std::size_t l = 0; l < c.small.inverse.levels.size(); ++l) {
        const auto outputs = run_kernel(*device_, {c.before.size()}, [&](auto& commands, const auto& out) {
          commands.copy({before, 0, sizeof(float) * c.before.size()}, out[0]);
          vulkan::record_block_gather(commands, kernel, {inverse, right_sides, results, out[0]}, inverse.levels[l],
                                      sides.count, sides.interleave);
        });
        expect_close(outputs[0], c.on_cpu(c.small.inverse.levels[l]), 0);  // sums in one order; other levels are left
      }
    }
  }
}

// Right sides at own slots, less what fronts below hand up to the same unknown; at boundary slots that alone.
TEST_F(BlockGather, ReferenceEqualsTheTextbook) {
  const Case c(20, {6, 3});
  const std::size_t slots = c.small.inverse.slot_count();
  std::vector<float> gathered;
  for (const InverseLevel& level : c.small.inverse.levels) {
    const std::vector<float> of_level = c.on_cpu(level);
    gathered.resize(of_level.size());
    for (std::size_t k = 0; k < of_level.size(); ++k) {
      if (level.first_slot <= k % slots && k % slots < level.end_slot) gathered[k] = of_level[k];
    }
  }
  for (std::size_t r = 0; r < 6; ++r) {
    for (std::size_t f = 0; f < SmallInverse::kFronts; ++f) {
      const SmallFront& front = c.small.fronts[f];
      const auto handed_up = [&](int unknown) {
        double sum = 0;
        for (std::size_t child = 2 * f + 1; child < std::min(2 * f + 3, SmallInverse::kFronts); ++child) {
          const SmallFront& below = c.small.fronts[child];
          for (std::size_t k = 0; k < below.boundary.size(); ++k) {
            if (below.boundary[k] == unknown) sum += c.results[r * slots + below.boundary_slot + k];
          }
        }
        return sum;
      };
      for (std::size_t k = 0; k < front.own.size(); ++k) {
        const double right_side =
            c.right_sides[place_of(c.small.inverse, {6, 3}, r, static_cast<std::size_t>(front.own[k]))];
        ASSERT_NEAR(gathered[r * slots + front.own_slot + k], right_side - handed_up(front.own[k]), 1e-6);
      }
      for (std::size_t k = 0; k < front.boundary.size(); ++k) {
        ASSERT_NEAR(gathered[r * slots + front.boundary_slot + k], handed_up(front.boundary[k]), 1e-6);
      }
    }
  }
}

}  // namespace block_gather_test
}  // namespace bodyopt::testing
