#include "runtime/cpu/dynamics_kernels.h"
#include "runtime/vulkan/kernels/kernels.h"
#include "tests/support/kernel_cases.h"
#include "tests/support/random_tets.h"

namespace bodyopt::testing {
namespace jiggle_skin_test {

constexpr std::uint32_t kNodes = 50;
constexpr float kWeight = 0.7f;

struct Case {
  Case(std::uint32_t seed, std::uint32_t vertices)
      : random(seed),
        tets(random_tets(random, kNodes)),
        positions(random.floats(std::size_t{3} * vertices, -1, 1)),
        displacement(random.floats(std::size_t{3} * kNodes, -0.1, 0.1)),
        moved(positions.size()) {
    tets.skin = random_tet_points(random, tets.tet_count(), vertices);
    // Of displacements of up to 0.17 m most are cut, some are not.
    tets.skin_limit = random.floats(vertices, 0.01, 0.4);
    cpu::jiggle_skin(tets, positions, displacement, kWeight, moved);
  }

  // A frame of a batch.
  KernelRun on(KernelSet& kernels, std::uint32_t frame, const std::vector<float>& batch, Expected expected) const {
    const auto vertices = static_cast<std::uint32_t>(tets.skin.size());
    return run_on<vulkan::JiggleSkin>(kernels, {vertices, frame, kWeight}, 1, {std::move(expected)}, tets.tets,
                                      tets.skin, tets.skin_limit, batch, displacement);
  }

  Random random;
  TetTable tets;
  std::vector<float> positions, displacement;
  std::vector<float> moved;  // by the reference
};

class JiggleSkin : public GpuTest {};

// One frame of a batch of three; the others are left.
const bool added = add_kernel_cases({"jiggle_skin",
                                     "vertices",
                                     "frame",
                                     {kSizes.begin(), kSizes.end()},
                                     {0, 2},
                                     [](KernelSet& kernels, const Trial& trial) {
                                       Case c(trial.seed(), trial.size);
                                       const auto begin =
                                           static_cast<std::ptrdiff_t>(trial.variant * c.positions.size());
                                       std::vector<float> batch = c.random.floats(3 * c.positions.size(), -1, 1);
                                       Expected expected{c.random.floats(batch.size(), -1, 1)};
                                       expected.before = expected.values;
                                       std::ranges::copy(c.positions, batch.begin() + begin);
                                       std::ranges::copy(c.moved, expected.values.begin() + begin);
                                       return c.on(kernels, trial.variant, batch, expected);
                                     }});

TEST_F(JiggleSkin, NoAmountChangesNoBit) {
  KernelSet kernels(*device_);
  Case c(100, 100);
  for (TetPoint& point : c.tets.skin) point.amount = 0;
  c.positions[0] = -0.0f;
  c.positions[4] = 1e-42f;
  std::fill(c.displacement.begin(), c.displacement.end(), std::nanf(""));
  cpu::jiggle_skin(c.tets, c.positions, c.displacement, kWeight, c.moved);
  EXPECT_EQ(std::memcmp(c.moved.data(), c.positions.data(), sizeof(float) * c.moved.size()), 0);
  const auto outputs = outputs_of(*device_, c.on(kernels, 0, c.positions, {c.moved}));
  EXPECT_EQ(std::memcmp(outputs[0].data(), c.positions.data(), sizeof(float) * c.moved.size()), 0);
}

// Nodes displaced by an affine field displace the skin by what each vertex takes of it.
TEST_F(JiggleSkin, ReproducesAnAffineDisplacement) {
  Case c(500, 500);
  std::ranges::fill(c.tets.skin_limit, kNoLimit);
  const Eigen::Matrix3d map = Eigen::Matrix3d::NullaryExpr([&] { return c.random.uniform(-0.1, 0.1); });
  const Eigen::Vector3d offset(0.03, -0.02, 0.05);
  const auto field = [&](const Eigen::Vector3d& at) -> Eigen::Vector3d { return map * at + offset; };
  c.displacement.clear();
  for (std::size_t n = 0; n < kNodes; ++n) append_point(c.displacement, field(point_of(c.tets.nodes, n)));
  cpu::jiggle_skin(c.tets, c.positions, c.displacement, kWeight, c.moved);
  for (std::size_t v = 0; v < 500; ++v) {
    const TetPoint& p = c.tets.skin[v];
    const float weights[4] = {p.w0, p.w1, p.w2, p.w3};
    Eigen::Vector3d at = Eigen::Vector3d::Zero();
    for (std::size_t k = 0; k < 4; ++k) {
      at += static_cast<double>(weights[k]) * point_of(c.tets.nodes, c.tets.tets[4 * p.tet + k]);
    }
    const Eigen::Vector3d expected = point_of(c.positions, v) + static_cast<double>(kWeight * p.amount) * field(at);
    ASSERT_LT((point_of(c.moved, v) - expected).cwiseAbs().maxCoeff(), 2e-7);
  }
}

// Nodes that all go one way by ever more: exactly so far up to half the limit; beyond as 1 - 1 / (4 s) says; always
// further, and never to the limit.
TEST_F(JiggleSkin, CutsWhatNearsTheLimit) {
  Case c(4, 4);
  const std::size_t vertex = 1;
  c.tets.skin[vertex].amount = 1;
  constexpr double kLimit = 0.2;
  c.tets.skin_limit[vertex] = static_cast<float>(kLimit);
  std::ranges::fill(c.positions, 0.0f);
  double before = 0;
  for (const double length : {0.01, 0.099, 0.101, 0.2, 0.5, 5.0, 500.0}) {
    c.displacement.clear();
    for (std::size_t n = 0; n < kNodes; ++n) append_point(c.displacement, length * Eigen::Vector3d(0.48, 0.6, -0.64));
    cpu::jiggle_skin(c.tets, c.positions, c.displacement, 1, c.moved);
    const double shown = point_of(c.moved, vertex).norm();
    const double expected = length <= kLimit / 2 ? length : kLimit * (1 - kLimit / (4 * length));
    EXPECT_NEAR(shown, expected, 1e-6) << length;
    EXPECT_GT(shown, before);
    EXPECT_LT(shown, kLimit);
    before = shown;
  }
}

}  // namespace jiggle_skin_test
}  // namespace bodyopt::testing
