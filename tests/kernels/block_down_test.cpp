#include "runtime/cpu/dynamics_kernels.h"
#include "runtime/vulkan/kernels/windows.h"
#include "tests/support/kernel_cases.h"
#include "tests/support/random_tables.h"
#include "tests/support/small_inverse.h"

namespace bodyopt::testing {
namespace block_down_test {

struct Case {
  Case(std::uint32_t seed, std::uint32_t own, RightSides right_sides)
      : random(seed),
        sides(right_sides),
        small(random, own),
        results(random.floats(std::size_t{sides.count} * small.inverse.slot_count(), -1, 1)),
        before(random.floats(std::size_t{sides.count} * small.inverse.unknown_count, -1, 1)) {}

  std::vector<float> on_cpu(const InverseLevel& level) const {
    std::vector<float> solutions = before;
    cpu::block_down(small.inverse, level, results, sides.count, sides.interleave, solutions);
    return solutions;
  }

  // Of one level, which leaves the others. Sums in one order.
  KernelRun on(KernelSet& kernels, std::uint32_t level) const {
    const vulkan::Device& device = kernels.device();
    struct Bound {
      vulkan::InverseBuffers inverse;
      vulkan::Buffer results;
    };
    const auto bound = std::make_shared<const Bound>(
        Bound{vulkan::upload_together<vulkan::InverseBuffers>(device, small.inverse, device.info()),
              vulkan::upload(device, results, "results")});
    return {{{.values = on_cpu(small.inverse.levels.at(level)), .before = before}},
            [&kernel = kernels.get<vulkan::BlockDown>(), bound, level, sides = sides](vulkan::Commands& commands,
                                                                                      const auto& out) {
              vulkan::record_block_down(commands, kernel, {bound->inverse, bound->results, out[0]},
                                        bound->inverse.levels[level], sides.count, sides.interleave);
            }};
  }

  Random random;
  RightSides sides;
  SmallInverse small;
  std::vector<float> results, before;
};

const bool added = add_kernel_cases({"block_down",
                                     "unknowns_a_front",
                                     "right_sides_and_level",
                                     {kFrontSizes.begin(), kFrontSizes.end()},
                                     {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11},
                                     [](KernelSet& kernels, const Trial& trial) {
                                       const Case c(trial.seed(), trial.size, kRightSides[trial.variant / kLevels]);
                                       return c.on(kernels, trial.variant % kLevels);
                                     }});

// y - W x_boundary at the unknowns of every front.
TEST(BlockDownReference, EqualsTheTextbook) {
  const Case c(1, 37, {6, 3});
  for (std::size_t r = 0; r < c.sides.count; ++r) {
    for (std::size_t f = 0; f < SmallInverse::kFronts; ++f) {
      const SmallFront& front = c.small.fronts[f];
      const std::vector<float> solutions = c.on_cpu(c.small.inverse.levels[f < 1 ? 2 : f < 3 ? 1 : 0]);
      const auto at = [&](const std::vector<float>& values, const std::vector<int>& unknowns) {
        Eigen::VectorXd picked(unknowns.size());
        for (std::size_t k = 0; k < unknowns.size(); ++k) {
          const std::size_t place = place_of(c.small.inverse, c.sides, r, static_cast<std::size_t>(unknowns[k]));
          picked[static_cast<Eigen::Index>(k)] = static_cast<double>(values[place]);
        }
        return picked;
      };
      const Eigen::VectorXd y =
          Eigen::Map<const Eigen::VectorXf>(c.results.data() + r * c.small.inverse.slot_count() + front.own_slot,
                                            static_cast<Eigen::Index>(front.own.size()))
              .cast<double>();
      EXPECT_LT((at(solutions, front.own) - y + front.w * at(c.before, front.boundary)).norm(), 1e-5);
    }
  }
}

}  // namespace block_down_test
}  // namespace bodyopt::testing
