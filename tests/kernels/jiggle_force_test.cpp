#include "runtime/cpu/dynamics_kernels.h"
#include "runtime/vulkan/kernels/jiggle_tables.h"
#include "runtime/vulkan/kernels/kernels.h"
#include "tests/support/corotated_matrix.h"
#include "tests/support/kernel_cases.h"

namespace bodyopt::testing {
namespace jiggle_force_test {

constexpr std::uint32_t kBatch = 3;

const bool added = add_kernel_cases("jiggle_force", "nodes", [](KernelSet& kernels, const Trial& trial) {
  Random random(trial.seed());
  const std::uint32_t count = trial.size, frame = random.below(kBatch);
  const TetTable table = random_tets(random, count);
  const JiggleTable jiggle = random_corotated(random, table);
  const std::vector<float> turns = random_rotations(random, kBatch * count, 3),
                           pulls = random.floats(std::size_t{9} * table.tet_count(), -1, 1),
                           p = random.floats(std::size_t{3} * count, -1, 1);
  std::vector<float> expected(p.size());
  cpu::jiggle_force(table, jiggle, of_frame(turns, 3 * p.size(), frame), pulls, p, expected);
  // Sums and products in one order.
  return run_on<vulkan::JiggleForce>(kernels, {count, frame}, 1, {{expected}}, table.shapes,
                                     vulkan::node_rows(table, jiggle), table.corners, vulkan::held_nodes(jiggle), turns,
                                     pulls, p);
});

// A block of tets, its nodes and tets turned at random.
struct Block {
  explicit Block(std::uint32_t seed)
      : random(seed),
        tets(block_tets(2, 2, 3)),
        jiggle(random_corotated(random, tets)),
        rotations(random_rotations(random, tets.node_count(), 3)),
        tet_rotations(random_rotations(random, tets.tet_count(), 3)) {}

  std::vector<float> times(const std::vector<float>& direction) const {
    std::vector<float> tractions(tet_rotations.size()), product(direction.size());
    cpu::jiggle_stress(tets, jiggle, rotations, tet_rotations, direction, tractions);
    cpu::jiggle_force(tets, jiggle, rotations, tractions, direction, product);
    return product;
  }

  Random random;
  TetTable tets;
  JiggleTable jiggle;
  std::vector<float> rotations, tet_rotations;
};

TEST(JiggleForceReference, ProductEqualsTheAssembledMatrix) {
  Block block(1);
  const Eigen::MatrixXd matrix = corotated_matrix(block.tets, block.jiggle, block.rotations, block.tet_rotations);
  for (int k = 0; k < 10; ++k) {
    const std::vector<float> p = block.random.floats(block.tets.nodes.size(), -1, 1);
    const Eigen::VectorXd expected = matrix * doubles(p);
    ASSERT_LT((doubles(block.times(p)) - expected).cwiseAbs().maxCoeff(), 1e-6 * expected.cwiseAbs().maxCoeff());
  }
}

// A uniform stress pulls at the surface alone.
TEST(JiggleForceReference, LinearDisplacementPullsAtTheSurface) {
  Block block(2);
  const std::size_t nodes = block.tets.node_count();
  for (std::size_t k = 0; k < block.tet_rotations.size(); ++k) block.tet_rotations[k] = k % 9 % 4 == 0 ? 1.0f : 0.0f;
  block.jiggle.elasticity.assign(block.tets.tet_count(), {2, 1});
  std::fill(block.jiggle.held_values.begin(), block.jiggle.held_values.end(), 0.0f);
  const Eigen::Matrix3d gradient = Eigen::Matrix3d::NullaryExpr([&] { return block.random.uniform(-1, 1); });
  std::vector<float> p;
  for (std::size_t n = 0; n < nodes; ++n) {
    append_point(p, matrix_of(block.rotations, n).transpose() * gradient * point_of(block.tets.nodes, n));
  }
  const std::vector<float> product = block.times(p);
  Eigen::Matrix3d moment = Eigen::Matrix3d::Zero();
  std::size_t inside = 0;
  for (std::size_t n = 0; n < nodes; ++n) {
    const Eigen::Vector3d x = point_of(block.tets.nodes, n),
                          force = matrix_of(block.rotations, n) * point_of(product, n);
    moment += force * x.transpose();
    if ((x.array() < 0.5).any() || (x.array() > Eigen::Array3d(1.5, 1.5, 2.5)).any()) continue;
    ++inside;
    EXPECT_LT(force.norm(), 1e-5);
  }
  EXPECT_EQ(inside, 2u);
  // Sum of f x^T is the volume times the stress.
  const Eigen::Matrix3d strain = (gradient + gradient.transpose()) / 2;
  EXPECT_LT((moment - 12 * (2 * strain.trace() * Eigen::Matrix3d::Identity() + 2 * strain)).norm(), 1e-4);
}

// The whole body turned, and the displacement with it: the force turns, too, that is, stays in the nodes' frames.
TEST(JiggleForceReference, TurnsWithTheBody) {
  Block block(3);
  std::vector<float> bent = block.random.floats(block.tets.nodes.size(), -0.2, 0.2), turned_nodes, turned_rotations;
  for (std::size_t k = 0; k < bent.size(); ++k) bent[k] += block.tets.nodes[k];
  const Eigen::Matrix3d turn = matrix_of(random_rotations(block.random, 1, 3), 0);
  for (std::size_t n = 0; n < block.tets.node_count(); ++n) {
    append_point(turned_nodes, turn * point_of(bent, n));
    const Eigen::Matrix3d columns = (turn * matrix_of(block.rotations, n)).transpose();
    for (int i = 0; i < 3; ++i) append_point(turned_rotations, columns.col(i));
  }
  const std::vector<float> p = block.random.floats(bent.size(), -1, 1);
  cpu::jiggle_tet_rotate(block.tets, bent, block.tet_rotations);
  const Eigen::VectorXd before = doubles(block.times(p));
  cpu::jiggle_tet_rotate(block.tets, turned_nodes, block.tet_rotations);
  block.rotations = turned_rotations;
  const Eigen::VectorXd after = doubles(block.times(p));
  EXPECT_LT((after - before).cwiseAbs().maxCoeff(), 1e-5 * before.cwiseAbs().maxCoeff());
}

}  // namespace jiggle_force_test
}  // namespace bodyopt::testing
