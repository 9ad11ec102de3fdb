#include "trainer/dynamics/elasticity.h"

#include <Eigen/LU>

namespace bodyopt {

SparseMatrix elastic_stiffness(const TetMesh& mesh, const std::vector<TetMaterial>& materials) {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(144 * static_cast<std::size_t>(mesh.tets.rows()));
  for (Eigen::Index t = 0; t < mesh.tets.rows(); ++t) {
    const Eigen::Matrix3d edges = tet_edges(mesh, t);
    Eigen::Matrix<double, 4, 3> slopes;
    slopes.bottomRows<3>() = edges.inverse();
    slopes.row(0) = -slopes.bottomRows<3>().colwise().sum();
    const double volume = edges.determinant() / 6;
    const TetMaterial& material = materials[static_cast<std::size_t>(t)];
    for (int a = 0; a < 4; ++a) {
      for (int b = 0; b < 4; ++b) {
        const Eigen::Vector3d of_a = slopes.row(a), of_b = slopes.row(b);
        Eigen::Matrix3d block = material.lambda * of_a * of_b.transpose() + material.mu * of_b * of_a.transpose();
        block.diagonal().array() += material.mu * of_a.dot(of_b);
        for (int i = 0; i < 3; ++i) {
          for (int k = 0; k < 3; ++k) {
            entries.emplace_back(3 * mesh.tets(t, a) + i, 3 * mesh.tets(t, b) + k, volume * block(i, k));
          }
        }
      }
    }
  }
  SparseMatrix matrix(3 * mesh.nodes.rows(), 3 * mesh.nodes.rows());
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

Eigen::VectorXd lumped_mass(const TetMesh& mesh, double density) {
  Eigen::VectorXd mass = Eigen::VectorXd::Zero(mesh.nodes.rows());
  for (Eigen::Index t = 0; t < mesh.tets.rows(); ++t) {
    const double quarter = density * tet_edges(mesh, t).determinant() / 24;
    for (int a = 0; a < 4; ++a) mass[mesh.tets(t, a)] += quarter;
  }
  return mass;
}

}  // namespace bodyopt
