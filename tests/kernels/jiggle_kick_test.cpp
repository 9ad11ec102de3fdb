#include <limits>

#include "runtime/cpu/dynamics_kernels.h"
#include "runtime/vulkan/kernels/kernels.h"
#include "tests/support/kernel_cases.h"
#include "tests/support/random_jiggle.h"

namespace bodyopt::testing {
namespace jiggle_kick_test {

struct State {
  explicit State(std::size_t count, float value = 0)
      : displacement(count, value), velocity(count, value), nodes(count, value), node_velocity(count, value) {}
  State(Random& random, std::size_t count)
      : displacement(random.floats(count, -1, 1)),
        velocity(random.floats(count, -1, 1)),
        nodes(random.floats(count, -1, 1)),
        node_velocity(random.floats(count, -1, 1)) {}

  State kicked(const JiggleKickPush& push, std::span<const float> x) const {
    State after(displacement.size());
    cpu::jiggle_kick(push, x, {displacement, velocity, nodes, node_velocity},
                     {after.displacement, after.velocity, after.nodes, after.node_velocity});
    return after;
  }

  std::vector<float> joined() const { return bodyopt::testing::joined({displacement, velocity, nodes, node_velocity}); }

  std::vector<float> displacement, velocity, nodes, node_velocity;
};

const bool added =
    add_kernel_cases({"jiggle_kick",
                      "nodes",
                      "start",
                      {kSizes.begin(), kSizes.end()},
                      {0, 1, 2},
                      [](KernelSet& kernels, const Trial& trial) {
                        Random random(trial.seed());
                        const std::uint32_t count = trial.size, start = trial.variant, frame = random.below(3);
                        const State before(random, std::size_t{3} * count);
                        const std::vector<float> batch = random.floats(std::size_t{9} * count, -1, 1);
                        const JiggleKickPush push{count, frame, start, 24, 0.25f, -1.5f, 0.03f};
                        const State after = before.kicked(push, of_frame(batch, std::size_t{3} * count, frame));
                        // Copies, sums and products in one order.
                        return run_on<vulkan::JiggleKick>(kernels, push, 1, {{after.joined()}}, batch, before.joined());
                      }});

// Of what was never set nothing is used.
TEST(JiggleKickReference, FirstFrameIsAtRest) {
  Random random(1);
  const std::vector<float> x = random.floats(30, -1, 1);
  const State unset(30, std::numeric_limits<float>::quiet_NaN());
  const State after = unset.kicked({10, 0, 0, 24, 1, 2, 3}, x);
  EXPECT_EQ(after.displacement, std::vector<float>(30, 0.0f));
  EXPECT_EQ(after.velocity, std::vector<float>(30, 0.0f));
  EXPECT_EQ(after.node_velocity, std::vector<float>(30, 0.0f));
  EXPECT_EQ(after.nodes, x);
}

// Nodes and origin both move in straight lines, by steps that floats hold exactly: never a kick, from the start on.
TEST(JiggleKickReference, StraightMotionGivesNoKick) {
  State state(3);
  for (std::uint32_t f = 0; f < 10; ++f) {
    const float t = static_cast<float>(f);
    const std::vector<float> x = {0.5f + 0.125f * t, -0.25f * t, 1};
    state = state.kicked({1, 0, std::min(f, 2u), 16, 0.0625f, 0, -0.5f}, x);
    EXPECT_EQ(state.velocity, std::vector<float>(3, 0.0f)) << "frame " << f;
    EXPECT_EQ(state.displacement, std::vector<float>(3, 0.0f));
  }
  EXPECT_EQ(state.node_velocity, (std::vector<float>{3, -4, -8}));
}

TEST(JiggleKickReference, HeldNodesGiveExactlyNothing) {
  Random random(2);
  const std::vector<float> x = random.floats(300, -1, 1);
  State state(300);
  for (std::uint32_t f = 0; f < 5; ++f) state = state.kicked({100, 0, std::min(f, 2u), 24, 0, 0, 0}, x);
  EXPECT_EQ(state.velocity, std::vector<float>(300, 0.0f));
  EXPECT_EQ(state.displacement, std::vector<float>(300, 0.0f));
}

// A turn of the path kicks by the change of the nodes' velocity; the displacement and the rest of the velocity stay.
TEST(JiggleKickReference, TurnKicksByTheChangeOfVelocity) {
  Random random(3);
  const State before(random, 30);
  const std::vector<float> x = random.floats(30, -1, 1);
  const double step[3] = {0.5, -0.25, 2}, rate = 24;
  const State after = before.kicked({10, 0, 2, 24, 0.5f, -0.25f, 2}, x);
  for (std::size_t k = 0; k < 30; ++k) {
    const double v = (static_cast<double>(x[k]) - static_cast<double>(before.nodes[k]) + step[k % 3]) * rate;
    EXPECT_NEAR(after.velocity[k], before.velocity[k] - (v - before.node_velocity[k]), 2e-5);
    EXPECT_NEAR(after.node_velocity[k], v, 2e-5);
  }
  EXPECT_EQ(after.displacement, before.displacement);
  // One frame known: the velocity is found, nothing kicks.
  EXPECT_EQ(before.kicked({10, 0, 1, 24, 0.5f, -0.25f, 2}, x).velocity, before.velocity);
  EXPECT_EQ(before.kicked({10, 0, 1, 24, 0.5f, -0.25f, 2}, x).node_velocity, after.node_velocity);
}

}  // namespace jiggle_kick_test
}  // namespace bodyopt::testing
