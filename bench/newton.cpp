#include "bench/newton.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SparseCholesky>
#include <cmath>

namespace bodyopt::bench {
namespace {

using Matrix9 = Eigen::Matrix<double, 9, 9>;
using Vector9 = Eigen::Matrix<double, 9, 1>;

// Slope and curvature of a scalar function.
struct Derivatives {
  double slope, curvature;
};

// As tissue.h has them: pressure over the volume ratio, tension over the stretch.
Derivatives of_volume(const TetMaterial& material, double j) {
  Derivatives d{material.lambda * (j - 1 - material.mu / material.lambda), material.lambda};
  if (j >= Tissue::kBarrierVolume) return d;
  const double at = std::max(j, Tissue::kBarrier.steepest), below = at - Tissue::kBarrierVolume,
               ratio = std::log(at / Tissue::kBarrierVolume), kappa = Tissue::kBarrierWeight * material.lambda;
  d.slope += kappa * (-2 * below * ratio - below * below / at);
  if (at == j) d.curvature += kappa * (-2 * ratio - 4 * below / at + below * below / (at * at));
  return d;
}

Derivatives of_stretch(const Materials& materials, double activation, double s) {
  const double active = activation * materials.active_fibre;
  return {active * std::max(s - materials.active_slack, 0.0) + materials.passive_fibre * std::max(s - 1, 0.0),
          (s > materials.active_slack ? active : 0) + (s > 1 ? materials.passive_fibre : 0)};
}

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v[2], v[1], v[2], 0, -v[0], -v[1], v[0], 0;
  return m;
}

// d2 Psi / dF2 over the columns of F.
Matrix9 block_of(const ElasticProblem& problem, int tet, const Eigen::Matrix3d& f, const FibreTet* fibre) {
  const TetMaterial& material = problem.tets[static_cast<std::size_t>(tet)];
  const Derivatives volume = of_volume(material, f.determinant());
  Eigen::Matrix3d cofactor;
  for (int k = 0; k < 3; ++k) cofactor.col(k) = f.col((k + 1) % 3).cross(f.col((k + 2) % 3));
  const Vector9 g = cofactor.reshaped();
  Matrix9 h = material.mu * Matrix9::Identity() + volume.curvature * g * g.transpose();
  for (int k = 0; k < 3; ++k) {  // d cofactor_k / d f_(k+1) = -[f_(k+2)]x, d / d f_(k+2) = [f_(k+1)]x
    const int k1 = (k + 1) % 3, k2 = (k + 2) % 3;
    h.block<3, 3>(3 * k, 3 * k1) -= volume.slope * cross_matrix(f.col(k2));
    h.block<3, 3>(3 * k, 3 * k2) += volume.slope * cross_matrix(f.col(k1));
  }
  if (fibre != nullptr) {
    const Eigen::Vector3d along = f * fibre->direction;
    const double s = along.norm();
    const Derivatives tension =
        of_stretch(problem.materials, problem.activation[static_cast<std::size_t>(fibre->muscle)], s);
    const Eigen::Matrix3d axial = along * along.transpose() / (s * s);
    const Eigen::Matrix3d stiffness =
        fibre->share * (tension.curvature * axial + tension.slope / s * (Eigen::Matrix3d::Identity() - axial));
    for (int a = 0; a < 3; ++a) {
      for (int b = 0; b < 3; ++b) {
        h.block<3, 3>(3 * a, 3 * b) += fibre->direction[a] * fibre->direction[b] * stiffness;
      }
    }
  }
  Eigen::SelfAdjointEigenSolver<Matrix9> eigen(h);
  return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0).asDiagonal() * eigen.eigenvectors().transpose();
}

}  // namespace

SparseMatrix projected_hessian(const ElasticProblem& problem, const Positions& nodes) {
  const TetMesh& mesh = problem.mesh;
  std::vector<const FibreTet*> fibre_of(static_cast<std::size_t>(mesh.tets.rows()), nullptr);
  for (const FibreTet& fibre : problem.fibres) fibre_of[static_cast<std::size_t>(fibre.tet)] = &fibre;
  std::vector<Eigen::Triplet<double>> entries;
  for (int t = 0; t < mesh.tets.rows(); ++t) {
    const Eigen::Matrix3d rest = tet_edges(mesh, t), inverse = rest.inverse();
    Eigen::Matrix3d edges;
    for (int a = 0; a < 3; ++a)
      edges.col(a) = (nodes.row(mesh.tets(t, a + 1)) - nodes.row(mesh.tets(t, 0))).transpose();
    Eigen::Matrix<double, 4, 3> slopes;  // of the shape functions
    slopes.bottomRows<3>() = inverse;
    slopes.row(0) = -inverse.colwise().sum();
    const Matrix9 h =
        rest.determinant() / 6 * block_of(problem, t, edges * inverse, fibre_of[static_cast<std::size_t>(t)]);
    for (int a = 0; a < 4; ++a) {
      for (int b = 0; b < 4; ++b) {
        Eigen::Matrix3d pair = Eigen::Matrix3d::Zero();
        for (int k = 0; k < 3; ++k) {
          for (int l = 0; l < 3; ++l) pair += slopes(a, k) * slopes(b, l) * h.block<3, 3>(3 * k, 3 * l);
        }
        for (int i = 0; i < 3; ++i) {
          for (int j = 0; j < 3; ++j)
            entries.emplace_back(3 * mesh.tets(t, a) + i, 3 * mesh.tets(t, b) + j, pair(i, j));
        }
      }
    }
  }
  for (int column = 0; column < problem.spring_stiffness.cols(); ++column) {
    for (SparseMatrix::InnerIterator it(problem.spring_stiffness, column); it; ++it) {
      for (int i = 0; i < 3; ++i) entries.emplace_back(3 * static_cast<int>(it.row()) + i, 3 * column + i, it.value());
    }
  }
  SparseMatrix hessian(3 * mesh.nodes.rows(), 3 * mesh.nodes.rows());
  hessian.setFromTriplets(entries.begin(), entries.end());
  return hessian;
}

MinimiseResult newton(const ElasticProblem& problem, const Objective& objective, double tolerance, Positions& nodes) {
  constexpr int kMostSteps = 200, kMostHalvings = 30;
  Eigen::SimplicialLDLT<SparseMatrix> factor;
  Positions gradient(nodes.rows(), 3);
  ObjectiveValue value = objective(nodes, gradient);
  const auto residual = [&] { return gradient.norm() / std::sqrt(value.force_square); };
  int step = 0;
  for (; step < kMostSteps && residual() > tolerance; ++step) {
    const SparseMatrix hessian = projected_hessian(problem, nodes);
    if (step == 0) factor.analyzePattern(hessian);
    factor.factorize(hessian);
    const Eigen::Map<const Eigen::VectorXd> flat(gradient.data(), gradient.size());
    const Eigen::VectorXd solved = factor.solve(-flat);
    const Eigen::Map<const Positions> direction(solved.data(), nodes.rows(), 3);
    const double slope = flat.dot(solved);
    bool lower = false;
    double length = 1;
    for (int halving = 0; halving < kMostHalvings && !lower; ++halving, length /= 2) {
      const Positions trial = nodes + length * direction;
      Positions trial_gradient(nodes.rows(), 3);
      const ObjectiveValue next = objective(trial, trial_gradient);
      lower = next.energy <= value.energy + 1e-4 * length * slope + 1e-12 * std::abs(value.energy);
      if (!lower) continue;
      nodes = trial;
      gradient = trial_gradient;
      value = next;
    }
    if (!lower) break;
  }
  return {residual(), step};
}

}  // namespace bodyopt::bench
