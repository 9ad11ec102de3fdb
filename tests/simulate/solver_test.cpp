#include <gtest/gtest.h>

#include <Eigen/LU>

#include "runtime/core/error.h"
#include "tests/simulate/limb.h"
#include "tests/support/textbook_algebra.h"
#include "trainer/simulate/lbfgs.h"
#include "trainer/tets/second_order.h"
#include "trainer/tets/tets.h"

namespace bodyopt::trainer {
namespace {

SparseMatrix random_definite(int size, unsigned seed) {
  std::srand(seed);
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < size; ++i) {
    entries.emplace_back(i, i, 10.0 + i % 7);
    const int j = std::rand() % size;
    if (i == j) continue;
    entries.emplace_back(i, j, -1.5);
    entries.emplace_back(j, i, -1.5);
  }
  SparseMatrix matrix(size, size);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

TEST(Metric, SolvesLikeADenseFactor) {
  const SparseMatrix matrix = random_definite(60, 5);
  const Positions right = Positions::Random(60, 3);
  Positions found = right;
  Metric::Scratch scratch;
  Metric(matrix).solve(found, scratch);
  const Positions expected = testing::textbook_solve(matrix, right);
  EXPECT_LT((found - expected).cwiseAbs().maxCoeff(), 1e-6);  // a factor in single precision
}

// Of tets of second order: symmetric and positive, and so near to the inverse that no error survives as more than half.
TEST(Metric, ACycleOfTwoGridsIsNearlyTheInverse) {
  const Character limb = make_limb();
  const TetMesh mesh = second_order(own_cage(limb.vertices, limb.triangles, limb.weights, 0.08)).mesh;
  const Eigen::Index count = mesh.nodes.rows();
  std::vector<double> stiffness(static_cast<std::size_t>(mesh.tets.rows()));
  for (std::size_t t = 0; t < stiffness.size(); ++t) stiffness[t] = t % 5 == 0 ? 2e6 : 1e5;
  SparseMatrix matrix = tet_laplacian(mesh, stiffness);
  for (Eigen::Index n = 0; n < count; n += 9) matrix.coeffRef(n, n) += 1e3;  // held here and there
  const Metric metric(matrix, from_corners(mesh));
  Metric::Scratch scratch;
  const auto solved = [&](Positions values) {
    metric.solve(values, scratch);
    return values;
  };
  const auto energy = [&](const Positions& values) { return values.cwiseProduct(matrix * values).sum(); };
  std::srand(11);
  const Positions a = Positions::Random(count, 3), b = Positions::Random(count, 3);
  const double ab = a.cwiseProduct(solved(b)).sum(), aa = a.cwiseProduct(solved(a)).sum();
  EXPECT_GT(aa, 0);
  EXPECT_NEAR(ab, b.cwiseProduct(solved(a)).sum(), 1e-5 * aa);
  Positions error = a;
  for (int cycle = 0; cycle < 12; ++cycle) {
    const double before = energy(error);
    error -= solved(matrix * error);
    EXPECT_LT(energy(error), 0.25 * before) << cycle;
  }
}

TEST(Metric, RefusesAnIndefiniteMatrix) {
  SparseMatrix matrix = random_definite(10, 1);
  matrix.coeffRef(4, 4) = -20;
  EXPECT_THROW(Metric{matrix}, Error);
}

TEST(Metric, LaplacianHasLinearPrecision) {
  const Character limb = make_limb();
  const TetMesh mesh = tetrahedralise(limb.vertices, limb.triangles, 0.05);
  const SparseMatrix laplacian =
      tet_laplacian(mesh, std::vector<double>(static_cast<std::size_t>(mesh.tets.rows()), 1));
  const Positions flux = laplacian * mesh.nodes;  // of a linear field: zero inside
  EXPECT_LT(flux.bottomRows(mesh.nodes.rows() - limb.vertices.rows()).cwiseAbs().maxCoeff(), 1e-14);
  EXPECT_GT(flux.topRows(limb.vertices.rows()).norm(), 1e-3);
}

// The Woodbury identity against a dense factor of the whole matrix.
TEST(StiffModes, SolvesLikeADenseFactorWithTheModes) {
  const SparseMatrix matrix = random_definite(30, 8);
  const std::vector<SparseMode> modes = {{{3, {1, -2, 0.5}}, {7, {0, 1, 4}}}, {{29, {3, 1, 1}}, {3, {0, 0.2, 0}}}};
  const std::vector<double> stiffness = {250, 3};
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(90, 90);
  for (int i = 0; i < 30; ++i) {
    for (int j = 0; j < 30; ++j) dense.block<3, 3>(3 * i, 3 * j) = matrix.coeff(i, j) * Eigen::Matrix3d::Identity();
  }
  for (std::size_t m = 0; m < 2; ++m) {
    Eigen::VectorXd g = Eigen::VectorXd::Zero(90);
    for (const auto& [node, vector] : modes[m]) g.segment<3>(3 * node) = vector.transpose();
    dense += stiffness[m] * g * g.transpose();
  }
  const Positions right = Positions::Random(30, 3);
  Positions found = right;
  Metric::Scratch scratch;
  const Metric metric(matrix);
  StiffModes(metric, 30, modes, stiffness).solve(found, scratch);
  const Eigen::VectorXd expected = testing::textbook_solve(dense, Eigen::Map<const Eigen::VectorXd>(right.data(), 90));
  EXPECT_LT((Eigen::Map<const Eigen::VectorXd>(found.data(), 90) - expected).cwiseAbs().maxCoeff(), 1e-6);
}

TEST(Minimise, FindsTheMinimumOfAQuadratic) {
  const SparseMatrix hessian = random_definite(40, 3);
  const Positions pull = Positions::Random(40, 3);
  SparseMatrix crude(40, 40);  // above the Hessian and without its shape: L-BFGS has to learn the rest
  crude.setIdentity();
  crude *= 30;
  const Objective objective = [&](const Positions& x, Positions& gradient) {
    gradient = hessian * x - pull;
    return ObjectiveValue{0.5 * x.cwiseProduct(gradient - pull).sum(), 1.0};
  };
  Positions x = Positions::Zero(40, 3);
  const Metric metric(crude);
  const MinimiseResult result = Lbfgs(StiffModes(metric, 40, {}, {}), 1e-12).minimise(objective, 1e-9, 500, x);
  EXPECT_LT(result.residual, 1e-9);
  const Positions expected = testing::textbook_solve(hessian, pull);
  EXPECT_LT((x - expected).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(Minimise, NeverEntersAPlaceOfInfiniteEnergy) {
  SparseMatrix metric(1, 1);
  metric.coeffRef(0, 0) = 0.01;  // the first step would go far beyond the wall at 0
  const Objective objective = [](const Positions& x, Positions& gradient) {
    gradient = Positions::Zero(1, 3);
    if (x(0, 0) <= 0) return ObjectiveValue{std::numeric_limits<double>::infinity(), 1};
    gradient(0, 0) = 1 - 1 / x(0, 0);
    return ObjectiveValue{x(0, 0) - std::log(x(0, 0)), 1};
  };
  Positions x(1, 3);
  x << 3, 0, 0;
  const Metric factor(metric);
  EXPECT_LT(Lbfgs(StiffModes(factor, 1, {}, {}), 1e-12).minimise(objective, 1e-8, 200, x).residual, 1e-8);
  EXPECT_NEAR(x(0, 0), 1, 1e-7);
}

// One iteration at a time: no point that is tried lies further from where the iteration starts than allowed, some lie
// that far, and the minimum, which is much further, is reached all the same.
TEST(Minimise, NoStepMovesANodeFurtherThanAllowed) {
  constexpr double kMaxMove = 0.05;
  const SparseMatrix hessian = random_definite(40, 3);
  const Positions minimum = Positions::Constant(40, 3, 1) + Positions::Random(40, 3);
  SparseMatrix soft(40, 40);  // far below the Hessian: the first step would go far beyond the minimum
  soft.setIdentity();
  Positions start = Positions::Zero(40, 3), x = start;
  double furthest = 0;
  const Objective objective = [&](const Positions& at, Positions& gradient) {
    furthest = std::max(furthest, (at - start).rowwise().norm().maxCoeff());
    gradient = hessian * (at - minimum);
    return ObjectiveValue{0.5 * (at - minimum).cwiseProduct(gradient).sum(), 1.0};
  };
  const Metric metric(soft);
  const StiffModes plain(metric, 40, {}, {});
  Lbfgs lbfgs(plain, 1e-12, kMaxMove);
  int iterations = 0, capped = 0;
  for (double residual = 1; residual >= 1e-9 && iterations < 1000; ++iterations) {
    furthest = 0;
    start = x;
    residual = lbfgs.minimise(objective, 1e-9, 1, x).residual;
    ASSERT_LE(furthest, kMaxMove * (1 + 1e-12)) << iterations;
    capped += furthest > kMaxMove * (1 - 1e-12) ? 1 : 0;
  }
  EXPECT_GT(capped, 0);
  EXPECT_LT((x - minimum).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(Minimise, ReportsWhatItReachedWhenTheIterationsEnd) {
  const SparseMatrix hessian = random_definite(40, 3);
  SparseMatrix crude(40, 40);
  crude.setIdentity();
  const Positions pull = Positions::Random(40, 3);
  const Objective objective = [&](const Positions& x, Positions& gradient) {
    gradient = hessian * x - pull;
    return ObjectiveValue{0.5 * x.cwiseProduct(gradient - pull).sum(), 4.0};
  };
  Positions x = Positions::Zero(40, 3);
  const Metric metric(crude);
  const MinimiseResult result = Lbfgs(StiffModes(metric, 40, {}, {}), 1e-12).minimise(objective, 1e-9, 3, x);
  EXPECT_EQ(result.iterations, 3);
  EXPECT_NEAR(result.residual, (hessian * x - pull).norm() / 2, 1e-12);
  EXPECT_GT(result.residual, 1e-9);
}

}  // namespace
}  // namespace bodyopt::trainer
