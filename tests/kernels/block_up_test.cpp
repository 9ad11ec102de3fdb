#include "runtime/cpu/dynamics_kernels.h"
#include "runtime/vulkan/kernels/windows.h"
#include "tests/support/kernel_cases.h"
#include "tests/support/random_tables.h"
#include "tests/support/small_inverse.h"

namespace bodyopt::testing {
namespace block_up_test {

struct Case {
  Case(std::uint32_t seed, std::uint32_t own, std::uint32_t count)
      : random(seed),
        right_side_count(count),
        small(random, own),
        gathered(random.floats(std::size_t{count} * small.inverse.slot_count(), -1, 1)),
        before(random.floats(gathered.size(), -1, 1)) {}

  std::vector<float> on_cpu(const InverseLevel& level) const {
    std::vector<float> results = before;
    cpu::block_up(small.inverse, level, gathered, right_side_count, results);
    return results;
  }

  // Of one level, which leaves the others. Sums in one order.
  KernelRun on(KernelSet& kernels, std::uint32_t level) const {
    const vulkan::Device& device = kernels.device();
    struct Bound {
      vulkan::InverseBuffers inverse;
      vulkan::Buffer gathered;
    };
    const auto bound = std::make_shared<const Bound>(
        Bound{vulkan::upload_together<vulkan::InverseBuffers>(device, small.inverse, device.info()),
              vulkan::upload(device, gathered, "gathered")});
    return {{{.values = on_cpu(small.inverse.levels.at(level)), .before = before}},
            [&kernel = kernels.get<vulkan::BlockUp>(), bound, level, count = right_side_count](
                vulkan::Commands& commands, const auto& out) {
              vulkan::record_block_up(commands, kernel, {bound->inverse, bound->gathered, out[0]},
                                      bound->inverse.levels[level], count);
            }};
  }

  Random random;
  std::uint32_t right_side_count;
  SmallInverse small;
  std::vector<float> gathered, before;
};

const bool added = add_kernel_cases({"block_up",
                                     "unknowns_a_front",
                                     "right_sides_and_level",
                                     {kFrontSizes.begin(), kFrontSizes.end()},
                                     {0, 1, 2, 3, 4, 5},
                                     [](KernelSet& kernels, const Trial& trial) {
                                       const Case c(trial.seed(), trial.size, trial.variant < kLevels ? 1u : 3u);
                                       return c.on(kernels, trial.variant % kLevels);
                                     }});

// P b at the own slots of every front, b_boundary + W^T b at its boundary slots.
TEST(BlockUpReference, EqualsTheTextbook) {
  const Case c(1, 37, 2);
  const std::size_t slots = c.small.inverse.slot_count();
  for (std::size_t r = 0; r < c.right_side_count; ++r) {
    for (std::size_t f = 0; f < SmallInverse::kFronts; ++f) {
      const SmallFront& front = c.small.fronts[f];
      const std::vector<float> results = c.on_cpu(c.small.inverse.levels[f < 1 ? 2 : f < 3 ? 1 : 0]);
      const auto part = [&](const std::vector<float>& values, std::size_t slot, std::size_t count) {
        return Eigen::Map<const Eigen::VectorXf>(values.data() + r * slots + slot, static_cast<Eigen::Index>(count))
            .cast<double>()
            .eval();
      };
      const Eigen::VectorXd own = part(c.gathered, front.own_slot, front.own.size());
      const Eigen::VectorXd boundary = part(c.gathered, front.boundary_slot, front.boundary.size());
      EXPECT_LT((part(results, front.own_slot, front.own.size()) - front.p * own).norm(), 1e-6);
      EXPECT_LT(
          (part(results, front.boundary_slot, front.boundary.size()) - boundary - front.w.transpose() * own).norm(),
          1e-6);
    }
  }
}

}  // namespace block_up_test
}  // namespace bodyopt::testing
