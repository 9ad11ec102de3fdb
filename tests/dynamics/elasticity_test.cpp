#include <gtest/gtest.h>

#include <Eigen/LU>
#include <numbers>

#include "base/linear_algebra.h"
#include "tests/support/fem_reference.h"
#include "tests/support/shared_data.h"
#include "tests/support/textbook_algebra.h"
#include "trainer/dynamics/jiggle.h"

namespace bodyopt::trainer {
namespace {

// The bar of 651 tets of the reference: E 1 MPa, Poisson 0.3, 1000 kg/m^3, clamped at one end.
struct Bar {
  explicit Bar(const Tensors& file) : mesh(reference_mesh(file)) {
    const double young = 1e6, poisson = 0.3;
    const TetMaterial material{young / (2 * (1 + poisson)), young * poisson / ((1 + poisson) * (1 - 2 * poisson))};
    stiffness = elastic_stiffness(mesh, std::vector<TetMaterial>(static_cast<std::size_t>(mesh.tets.rows()), material));
    mass = lumped_mass(mesh, 1000);
    std::vector<bool> fixed(static_cast<std::size_t>(mesh.nodes.rows()), false);
    for (const std::int32_t n : file.get<std::int32_t>("fixed")) fixed[static_cast<std::size_t>(n)] = true;
    for (int k = 0; k < 3 * mesh.nodes.rows(); ++k) {
      if (!fixed[static_cast<std::size_t>(k / 3)]) free.push_back(k);
    }
  }

  // The rows and columns of a matrix that are free.
  Eigen::MatrixXd of_free(const SparseMatrix& matrix) const { return Eigen::MatrixXd(matrix)(free, free); }

  TetMesh mesh;
  SparseMatrix stiffness;
  Eigen::VectorXd mass;
  std::vector<int> free;
};

// Of linear shape functions: volume density / 20 between corners, twice that on the diagonal.
SparseMatrix consistent_mass(const TetMesh& mesh, double density) {
  std::vector<Eigen::Triplet<double>> entries;
  for (Eigen::Index t = 0; t < mesh.tets.rows(); ++t) {
    const double share = density * tet_edges(mesh, t).determinant() / 120;
    for (int a = 0; a < 4; ++a) {
      for (int b = 0; b < 4; ++b) {
        for (int i = 0; i < 3; ++i) {
          entries.emplace_back(3 * mesh.tets(t, a) + i, 3 * mesh.tets(t, b) + i, (a == b ? 2 : 1) * share);
        }
      }
    }
  }
  SparseMatrix matrix(3 * mesh.nodes.rows(), 3 * mesh.nodes.rows());
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

// The lowest, Hz.
Eigen::VectorXd frequencies(const Eigen::MatrixXd& stiffness, const Eigen::MatrixXd& mass, Eigen::Index count) {
  return testing::generalised_eigenvalues(stiffness, mass).head(count).cwiseSqrt() / (2 * std::numbers::pi);
}

TEST(Elasticity, BarBendsAsAnotherProgramSays) {
  const auto path = shared_data("reference/fem/bar-651_static.safetensors");
  if (!path) GTEST_SKIP() << kNeedsReferences;
  const Tensors file(*path);
  const Bar bar(file);
  Eigen::VectorXd force = Eigen::VectorXd::Zero(bar.stiffness.rows());
  for (Eigen::Index n = 0; n < bar.mass.size(); ++n) force[3 * n + 1] = -9.81 * bar.mass[n];
  const auto where = file.get<std::int32_t>("load_node_axis");
  const auto load = file.get<double>("load_newton");
  for (std::size_t k = 0; k < load.size(); ++k) force[3 * where[2 * k] + where[2 * k + 1]] += load[k];
  const Eigen::MatrixXd expected = reference_field(file, "displacement_p1");

  Eigen::VectorXd displacement = Eigen::VectorXd::Zero(force.size());
  const Eigen::VectorXd of_free = force(bar.free);
  const Eigen::VectorXd solved = Cholesky(bar.of_free(bar.stiffness)).solve(of_free);
  displacement(bar.free) = solved;
  double error = 0;
  for (Eigen::Index n = 0; n < expected.rows(); ++n) {
    error = std::max(error, (displacement.segment<3>(3 * n) - expected.row(n).transpose()).norm());
  }
  EXPECT_LT(error, 1e-6 * expected.rowwise().norm().maxCoeff());
}

// Lumping puts mass further out: frequencies fall, those of the four lowest modes (bending) by 4 % at most. The fifth
// turns this bar, one or two tets thick, about its axis.
TEST(Elasticity, FrequenciesAreThoseOfTheConsistentMassAndNearlyOfTheLumpedOne) {
  const auto path = shared_data("reference/fem/bar-651_static.safetensors");
  if (!path) GTEST_SKIP() << kNeedsReferences;
  const Tensors file(*path);
  const Bar bar(file);
  const auto expected = file.get<double>("frequency_hz_consistent_mass");
  const auto count = static_cast<Eigen::Index>(expected.size());
  const Eigen::MatrixXd stiffness = bar.of_free(bar.stiffness);
  const Eigen::VectorXd consistent = frequencies(stiffness, bar.of_free(consistent_mass(bar.mesh, 1000)), count);
  Eigen::VectorXd three(3 * bar.mass.size());
  for (Eigen::Index k = 0; k < three.size(); ++k) three[k] = bar.mass[k / 3];
  const Eigen::VectorXd lumped = frequencies(stiffness, Eigen::MatrixXd(three(bar.free).asDiagonal()), count);
  for (Eigen::Index k = 0; k < count; ++k) {
    EXPECT_NEAR(consistent[k] / expected[static_cast<std::size_t>(k)], 1, 1e-6) << k;
    EXPECT_LT(lumped[k], consistent[k]) << k;
    if (k < 4) {
      EXPECT_GT(lumped[k], 0.96 * consistent[k]) << k;
    }
  }
}

// A turn to first order stretches nothing; a stretch along x by e costs volume (lambda / 2 + mu) e^2.
TEST(Elasticity, EnergyOfTurnsAndStretches) {
  TetMesh mesh;
  mesh.nodes.resize(5, 3);
  mesh.nodes << 0, 0, 0, 2, 0.1, 0, 0.3, 1, 0.2, 0, 0.2, 1, 1, 1, 1.4;
  mesh.tets.resize(2, 4);
  mesh.tets << 0, 1, 2, 3, 1, 2, 3, 4;
  orient(mesh);
  const SparseMatrix stiffness = elastic_stiffness(mesh, {{3, 7}, {3, 7}});
  double volume = 0;
  for (Eigen::Index t = 0; t < 2; ++t) volume += tet_edges(mesh, t).determinant() / 6;
  Eigen::VectorXd turn(15), stretch = Eigen::VectorXd::Zero(15);
  for (Eigen::Index n = 0; n < 5; ++n) {
    turn.segment<3>(3 * n) = Eigen::Vector3d(0.3, -1, 2).cross(Eigen::Vector3d(mesh.nodes.row(n)));
    stretch[3 * n] = 0.1 * mesh.nodes(n, 0);
  }
  EXPECT_LT((stiffness * turn).norm(), 1e-12 * stiffness.norm());
  EXPECT_NEAR(0.5 * stretch.dot(stiffness * stretch), volume * (3.5 + 3) * 0.01, 1e-12);
  EXPECT_NEAR(lumped_mass(mesh, 1000).sum(), 1000 * volume, 1e-9);
}

}  // namespace
}  // namespace bodyopt::trainer
