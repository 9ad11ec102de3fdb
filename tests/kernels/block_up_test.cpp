#include "runtime/cpu/dynamics_kernels.h"
#include "runtime/vulkan/kernels/windows.h"
#include "tests/support/gpu_fixture.h"
#include "tests/support/small_inverse.h"

namespace bodyopt::testing {
namespace block_up_test {

struct Case {
  Case(std::uint32_t own, std::uint32_t count)
      : random(own + 31 * count),
        right_side_count(count),
        small(random, own),
        gathered(random.floats(std::size_t{count} * small.inverse.slot_count(), -1, 1)),
        before(random.floats(gathered.size(), -1, 1)) {}

  std::vector<float> on_cpu(const InverseLevel& level) const {
    std::vector<float> results = before;
    cpu::block_up(small.inverse, level, gathered, right_side_count, results);
    return results;
  }

  Random random;
  std::uint32_t right_side_count;
  SmallInverse small;
  std::vector<float> gathered, before;
};

class BlockUp : public GpuTest {};

TEST_F(BlockUp, EqualsTheReference) {
  const vulkan::BlockUp kernel(*device_);
  for (const std::uint32_t own : kFrontSizes) {
    for (const std::uint32_t right_sides : {1u, 3u}) {
      SCOPED_TRACE(std::to_string(own) + " unknowns a front, " + std::to_string(right_sides) + " right sides");
      const Case c(own, right_sides);
      const vulkan::InverseBuffers inverse(*device_, c.small.inverse, device_->info());
      const auto gathered = vulkan::upload(*device_, c.gathered, "gathered"),
                 before = vulkan::upload(*device_, c.before, "before");
      for (std::size_t l = 0; l < c.small.inverse.levels.size(); ++l) {
        const auto outputs = run_kernel(*device_, {c.before.size()}, [&](auto& commands, const auto& out) {
          commands.copy({before, 0, sizeof(float) * c.before.size()}, out[0]);
          vulkan::record_block_up(commands, kernel, {inverse, gathered, out[0]}, inverse.levels[l], right_sides);
        });
        expect_close(outputs[0], c.on_cpu(c.small.inverse.levels[l]), 0);  // one order; other levels are left
      }
    }
  }
}

// P b at the own slots of every front, b_boundary + W^T b at its boundary slots.
TEST_F(BlockUp, ReferenceEqualsTheTextbook) {
  const Case c(37, 2);
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
