// Every set of instructions that the processor has gives the same bits.
#include "tests/support/instruction_sets.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/simulate/tet_block.h"
#include "trainer/simulate/metric.h"
#include "trainer/simulate/tissue.h"

namespace bodyopt::trainer {
namespace {

// Its tets are strained, some beyond the barrier or inside out; most have fibres, every third those of two muscles.
struct CrumpledBlock {
  TetMesh mesh = tet_block(5, 4, 3, 0.01);
  std::vector<TetMaterial> materials;
  std::vector<FibreTet> fibres;
  std::vector<FibreDrive> drives{{0.6, 0.7}, {0.9, 0.85}};
  Positions nodes = mesh.nodes;

  CrumpledBlock() {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> shift(-0.004, 0.004);
    for (Eigen::Index n = 0; n < nodes.rows(); ++n) {
      for (int i = 0; i < 3; ++i) nodes(n, i) += shift(random);
    }
    for (int t = 0; t < mesh.tets.rows(); ++t) {
      materials.push_back({4e3 + t, 8e4});
      if (t % 5 > 0) fibres.push_back({t, t % 2, Eigen::Vector3d(1, t % 4, 2).normalized(), 0.6});
      if (t % 3 == 0) fibres.push_back({t, 1 - t % 2, Eigen::Vector3d(0, 1, t % 3).normalized(), 0.3});
    }
  }
};

template <typename Result>
void expect_same_bits(const std::function<Result()>& find) {
  Result first;
  bool is_first = true;
  const int sets = testing::with_each_instruction_set([&](const std::string& name) {
    const Result result = find();
    if (is_first) first = result;
    EXPECT_EQ(result, first) << name;
    is_first = false;
  });
  EXPECT_GT(sets, 2);
}

TEST(InstructionSets, GiveTheSameForces) {
  const CrumpledBlock block;
  const Tissue tissue(block.mesh, block.materials, block.fibres);
  expect_same_bits<std::vector<double>>([&] {
    Positions gradient = Positions::Zero(block.nodes.rows(), 3);
    const TissueSum sum = tissue.add_gradient(block.nodes, block.drives, gradient);
    std::vector<double> result(gradient.data(), gradient.data() + gradient.size());
    result.insert(result.end(), {sum.energy, sum.force_square, tissue.inverted(block.nodes).share});
    EXPECT_GT(result.back(), 0);
    return result;
  });
}

TEST(InstructionSets, GiveTheSameStepsInAMetric) {
  const CrumpledBlock block;
  SparseMatrix matrix = tet_laplacian(block.mesh, std::vector<double>(block.materials.size(), 1));
  for (Eigen::Index n = 0; n < matrix.rows(); ++n) matrix.coeffRef(n, n) += 1e-3;
  const Metric metric(matrix);
  expect_same_bits<Positions>([&] {
    Positions values = block.nodes;
    Metric::Scratch scratch;
    metric.solve(values, scratch);
    return values;
  });
}

}  // namespace
}  // namespace bodyopt::trainer
