#include "runtime/cpu/dynamics_kernels.h"
#include "runtime/vulkan/kernels/kernels.h"
#include "tests/support/corotated_matrix.h"
#include "tests/support/kernel_cases.h"

namespace bodyopt::testing {
namespace jiggle_stress_test {

constexpr std::uint32_t kBatch = 3;

struct Case {
  explicit Case(std::uint32_t count)
      : random(count),
        frame(random.below(kBatch)),
        tets(random_tets(random, count)),
        jiggle(random_corotated(random, tets)),
        rotations(random_rotations(random, kBatch * count, 3)),
        tet_rotations(random_rotations(random, tets.tet_count(), 3)),
        direction(random.floats(std::size_t{3} * count, -1, 1)),
        tractions(tet_rotations.size()) {
    run();
  }

  std::span<const float> frame_rotations() const { return of_frame(rotations, 3 * direction.size(), frame); }
  void run() { cpu::jiggle_stress(tets, jiggle, frame_rotations(), tet_rotations, direction, tractions); }

  Random random;
  std::uint32_t frame;
  TetTable tets;
  JiggleTable jiggle;
  std::vector<float> rotations, tet_rotations, direction;
  std::vector<float> tractions;  // by the reference
};

const bool added = add_kernel_cases("jiggle_stress", "nodes", [](KernelSet& kernels, const Trial& trial) {
  const Case c(trial.size);
  // Sums and products in one order.
  return run_on<vulkan::JiggleStress>(kernels, {c.tets.tet_count(), trial.size, c.frame}, 1, {{c.tractions}},
                                      c.tets.tets, c.tets.shapes, c.jiggle.elasticity, c.rotations, c.tet_rotations,
                                      c.direction);
});

// p = Q B x in the world: in a tet turned by R the stress is R (lambda tr(e) I + 2 mu e), e the symmetric part of
// R^T Q B.
TEST(JiggleStressReference, LinearDisplacementGivesTheTextbooksStress) {
  Case c(100);
  const Eigen::Matrix3d gradient = Eigen::Matrix3d::NullaryExpr([&] { return c.random.uniform(-1, 1); });
  for (std::size_t n = 0; n < 100; ++n) {
    const Eigen::Vector3d local = matrix_of(c.frame_rotations(), n).transpose() * gradient * point_of(c.tets.nodes, n);
    for (int i = 0; i < 3; ++i) c.direction[3 * n + static_cast<std::size_t>(i)] = static_cast<float>(local[i]);
  }
  c.run();
  for (std::size_t t = 0; t < c.tets.tet_count(); ++t) {
    const Eigen::Matrix3d r = matrix_of(c.tet_rotations, t), local = r.transpose() * gradient;
    const Eigen::Matrix3d strain = (local + local.transpose()) / 2;
    const double volume = tet_edges(c.tets.nodes, c.tets.tets.data() + 4 * t).determinant() / 6;
    const Eigen::Matrix3d expected = volume * r *
                                     (c.jiggle.elasticity[t].lambda * strain.trace() * Eigen::Matrix3d::Identity() +
                                      2 * c.jiggle.elasticity[t].mu * strain);
    ASSERT_LT((matrix_of(c.tractions, t) - expected).norm(), 2e-4) << "tet " << t;
  }
}

TEST(JiggleStressReference, NothingGivesExactlyNothing) {
  Case c(100);
  std::fill(c.direction.begin(), c.direction.end(), 0.0f);
  c.run();
  EXPECT_EQ(c.tractions, std::vector<float>(c.tractions.size(), 0.0f));
}

}  // namespace jiggle_stress_test
}  // namespace bodyopt::testing
