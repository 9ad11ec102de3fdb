#include "trainer/dynamics/block_inverse.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <random>

#include "base/linear_algebra.h"
#include "runtime/core/error.h"
#include "runtime/cpu/dynamics_kernels.h"
#include "tests/support/on_threads.h"

namespace bodyopt::testing {
namespace {

using namespace trainer;

using SparseMatrix = Eigen::SparseMatrix<double>;

// A symmetric positive definite system on random points of a box that are joined to all within a distance: blocks of
// random numbers, strengths over `decades` powers of ten.
struct System {
  System(int count, int components, double decades, unsigned seed) : points(count, 3) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(0, 1);
    for (int i = 0; i < count; ++i) points.row(i) << unit(random), unit(random), 3 * unit(random);
    const double near = 1.3 * std::cbrt(3.0 / count);
    std::vector<Eigen::Triplet<double>> entries;
    for (int i = 0; i < count * components; ++i) entries.emplace_back(i, i, 1e-3);
    for (int i = 0; i < count; ++i) {
      for (int j = 0; j < i; ++j) {
        if ((points.row(i) - points.row(j)).norm() > near) continue;
        const Eigen::MatrixXd root = Eigen::MatrixXd::Random(components, components);
        const Eigen::MatrixXd block = std::pow(10, decades * unit(random)) * root * root.transpose();
        for (int a = 0; a < components; ++a) {
          for (int b = 0; b < components; ++b) {
            const double value = block(a, b);
            entries.emplace_back(components * i + a, components * i + b, value);
            entries.emplace_back(components * j + a, components * j + b, value);
            entries.emplace_back(components * i + a, components * j + b, -value);
            entries.emplace_back(components * j + a, components * i + b, -value);
          }
        }
      }
    }
    matrix.resize(count * components, count * components);
    matrix.setFromTriplets(entries.begin(), entries.end());
  }

  Positions points;
  SparseMatrix matrix;
};

Eigen::VectorXf solve(const BlockInverse& inverse, const Eigen::VectorXf& right_side) {
  Eigen::VectorXf solution = Eigen::VectorXf::Constant(right_side.size(), std::nanf(""));
  std::vector<float> scratch;
  cpu::block_solve(inverse, {right_side.data(), static_cast<std::size_t>(right_side.size())}, 1, 1, scratch,
                   {solution.data(), static_cast<std::size_t>(solution.size())});
  return solution;
}

double relative_error(const System& system, int components) {
  const BlockInverse inverse = invert(system.matrix, system.points, components);
  const SparseSolver direct(system.matrix);
  const Eigen::VectorXf right_side = Eigen::VectorXf::Random(system.matrix.rows());
  const Eigen::VectorXd expected = direct.solve(right_side.cast<double>());
  return (solve(inverse, right_side).cast<double>() - expected).norm() / expected.norm();
}

TEST(BlockInverse, EqualsASparseDirectSolve) {
  for (const int components : {1, 3}) {
    for (const int count : {1, 2, 31, 33, 100, 700}) {
      SCOPED_TRACE(std::to_string(count) + " nodes of " + std::to_string(components));
      EXPECT_LT(relative_error(System(count, components, 0, 7), components), 1e-5);
    }
  }
}

TEST(BlockInverse, HoldsOverSixDecadesOfStiffness) { EXPECT_LT(relative_error(System(500, 3, 6, 3), 3), 1e-3); }

TEST(BlockInverse, OfNothingIsEmpty) {
  const BlockInverse inverse = invert(SparseMatrix(0, 0), Positions(0, 3), 3);
  EXPECT_EQ(inverse.slot_count(), 0u);
  EXPECT_TRUE(inverse.levels.empty());
}

TEST(BlockInverse, OfPartsThatAreNotJoinedSolvesEach) {
  const System one(90, 3, 0, 5);
  System two = one;
  const auto n = one.matrix.rows();
  std::vector<Eigen::Triplet<double>> entries;
  for (int column = 0; column < one.matrix.outerSize(); ++column) {
    for (SparseMatrix::InnerIterator entry(one.matrix, column); entry; ++entry) {
      entries.emplace_back(entry.row(), entry.col(), entry.value());
      entries.emplace_back(entry.row() + n, entry.col() + n, entry.value());
    }
  }
  two.matrix.resize(2 * n, 2 * n);
  two.matrix.setFromTriplets(entries.begin(), entries.end());
  two.points.resize(2 * one.points.rows(), 3);
  two.points << one.points, one.points.rowwise() + Eigen::RowVector3d(9, 0, 0);
  EXPECT_LT(relative_error(two, 3), 1e-5);
}

TEST(BlockInverse, LeavesUnknownsThatAreNobodys) {
  const System system(50, 1, 0, 2);
  InverseNodes nodes{system.points, {}, 100};
  for (int i = 0; i < 50; ++i) nodes.nodes.push_back(2 * i + 1);
  const BlockInverse inverse = invert(system.matrix, nodes, 1);
  const Eigen::VectorXf right_side = Eigen::VectorXf::Random(100);
  const Eigen::VectorXf solution = solve(inverse, right_side);
  Eigen::VectorXd own(50), found(50);
  for (int i = 0; i < 50; ++i) {
    EXPECT_TRUE(std::isnan(solution[2 * i]));
    own[i] = static_cast<double>(right_side[2 * i + 1]);
    found[i] = static_cast<double>(solution[2 * i + 1]);
  }
  EXPECT_LT((system.matrix * found - own).norm(), 1e-4 * own.norm());
}

TEST(BlockInverse, IsTheSameOnAnyNumberOfThreads) {
  const System system(600, 3, 2, 11);
  const auto inverted = [&] { return invert(system.matrix, system.points, 3); };
  const BlockInverse one = on_threads(1, inverted), three = on_threads(3, inverted);
  EXPECT_EQ(one.values, three.values);
  EXPECT_EQ(one.slot_unknown, three.slot_unknown);
}

TEST(BlockInverse, RefusesASingularSystem) {
  System system(40, 1, 0, 1);
  for (int i = 0; i < 40; ++i) system.matrix.coeffRef(i, i) -= 1e-3;  // held by nothing
  system.matrix.coeffRef(0, 0) -= 1e-6;
  EXPECT_THROW(invert(system.matrix, system.points, 1), Error);
}

// No node of a front may touch a node of another branch: what is eliminated side by side must not be joined.
TEST(Dissection, SeparatesAllThatIsNotInOneBranch) {
  const System system(900, 1, 0, 4);
  Graph graph(900);
  for (int column = 0; column < 900; ++column) {
    for (SparseMatrix::InnerIterator entry(system.matrix, column); entry; ++entry) {
      if (entry.row() != column) graph[static_cast<std::size_t>(column)].push_back(static_cast<int>(entry.row()));
    }
  }
  const std::vector<DissectedFront> tree = dissect(graph, system.points);
  std::vector<int> front_of(900, -1), parent(tree.size(), -1);
  std::size_t largest = 0;
  for (std::size_t f = 0; f < tree.size(); ++f) {
    for (const int node : tree[f].own) {
      EXPECT_EQ(front_of[static_cast<std::size_t>(node)], -1);
      front_of[static_cast<std::size_t>(node)] = static_cast<int>(f);
    }
    for (const int child : tree[f].children) {
      if (child >= 0) parent[static_cast<std::size_t>(child)] = static_cast<int>(f);
    }
    largest = std::max(largest, tree[f].own.size());
  }
  const auto is_above = [&](int front, int other) {
    for (; other >= 0; other = parent[static_cast<std::size_t>(other)]) {
      if (other == front) return true;
    }
    return false;
  };
  for (std::size_t node = 0; node < 900; ++node) {
    ASSERT_GE(front_of[node], 0);
    for (const int other : graph[node]) {
      const int a = front_of[node], b = front_of[static_cast<std::size_t>(other)];
      EXPECT_TRUE(is_above(a, b) || is_above(b, a));
    }
  }
  EXPECT_LT(largest, 250u);  // a plane through the middle touches about 900^(2/3) nodes
}

}  // namespace
}  // namespace bodyopt::testing
