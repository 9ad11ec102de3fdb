#include "runtime/cpu/dynamics_kernels.h"
#include "runtime/vulkan/kernels/windows.h"
#include "tests/support/gpu_fixture.h"
#include "tests/support/small_inverse.h"

namespace bodyopt::testing {
namespace block_down_test {

struct Case {
  Case(std::uint32_t own, RightSides right_sides)
      : random(own + 31 * right_sides.count),
        sides(right_sides),
        small(random, own),
        results(random.floats(std::size_t{sides.count} * small.inverse.slot_count(), -1, 1)),
        before(random.floats(std::size_t{sides.count} * small.inverse.unknown_count, -1, 1)) {}

  std::vector<float> on_cpu(const InverseLevel& level) const {
    std::vector<float> solutions = before;
    cpu::block_down(small.inverse, level, results, sides.count, sides.interleave, solutions);
    return solutions;
  }

  Random random;
  RightSides sides;
  SmallInverse small;
  std::vector<float> results, before;
};

class BlockDown : public GpuTest {};

TEST_F(BlockDown, EqualsTheReference) {
  const vulkan::BlockDown kernel(*device_);
  for (const std::uint32_t own : kFrontSizes) {
    for (const RightSides sides : kRightSides) {
      SCOPED_TRACE(std::to_string(own) + " unknowns a front, " + std::to_string(sides.count) + " right sides");
      const Case c(own, sides);
      const vulkan::InverseBuffers inverse(*device_, c.small.inverse, device_->info());
      const auto results = vulkan::upload(*device_, c.results, "results"),
                 before = vulkan::upload(*device_, c.before, "before");
      for (std::size_t l = 0; l < c.small.inverse.levels.size(); ++l) {
        const auto outputs = run_kernel(*device_, {c.before.size()}, [&](auto& commands, const auto& out) {
          commands.copy({before, 0, sizeof(float) * c.before.size()}, out[0]);
          vulkan::record_block_down(commands, kernel, {inverse, results, out[0]}, inverse.levels[l], sides.count,
                                    sides.interleave);
        });
        expect_close(outputs[0], c.on_cpu(c.small.inverse.levels[l]), 0);  // one order; other unknowns are left
      }
    }
  }
}

// y - W x_boundary at the unknowns of every front.
TEST_F(BlockDown, ReferenceEqualsTheTextbook) {
  const Case c(37, {6, 3});
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
