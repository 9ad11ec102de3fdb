#include "runtime/cpu/dynamics_kernels.h"
#include "runtime/vulkan/kernels/windows.h"
#include "tests/support/kernel_cases.h"
#include "tests/support/random_tables.h"
#include "tests/support/small_inverse.h"

namespace bodyopt::testing {
namespace block_gather_test {

struct Case {
  Case(std::uint32_t seed, std::uint32_t own, RightSides right_sides_)
      : random(seed),
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

  // Of one level, which leaves the others. Sums in one order.
  KernelRun on(KernelSet& kernels, std::uint32_t level) const {
    const vulkan::Device& device = kernels.device();
    struct Bound {
      vulkan::InverseBuffers inverse;
      vulkan::Buffer right_sides, results;
    };
    const auto bound = std::make_shared<const Bound>(
        Bound{vulkan::upload_together<vulkan::InverseBuffers>(device, small.inverse, device.info()),
              vulkan::upload(device, right_sides, "right sides"), vulkan::upload(device, results, "results")});
    return {{{.values = on_cpu(small.inverse.levels.at(level)), .before = before}},
            [&kernel = kernels.get<vulkan::BlockGather>(), bound, level, sides = sides](vulkan::Commands& commands,
                                                                                        const auto& out) {
              vulkan::record_block_gather(commands, kernel,
                                          {bound->inverse, bound->right_sides, bound->results, out[0]},
                                          bound->inverse.levels[level], sides.count, sides.interleave);
            }};
  }

  Random random;
  RightSides sides;
  SmallInverse small;
  std::vector<float> right_sides, results, before;
};

const bool added = add_kernel_cases({"block_gather",
                                     "unknowns_a_front",
                                     "right_sides_and_level",
                                     {kFrontSizes.begin(), kFrontSizes.end()},
                                     {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11},
                                     [](KernelSet& kernels, const Trial& trial) {
                                       const Case c(trial.seed(), trial.size, kRightSides[trial.variant / kLevels]);
                                       return c.on(kernels, trial.variant % kLevels);
                                     }});

// Right sides at own slots, less what fronts below hand up to the same unknown; at boundary slots that alone.
TEST(BlockGatherReference, EqualsTheTextbook) {
  const Case c(1, 20, {6, 3});
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
