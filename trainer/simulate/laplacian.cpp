#include "trainer/simulate/laplacian.h"

#include <Eigen/LU>

namespace bodyopt {

Eigen::SparseMatrix<double> tet_laplacian(const TetMesh& mesh, const std::vector<double>& weights) {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(16 * weights.size());
  for (Eigen::Index e = 0; e < mesh.tets.rows(); ++e) {
    Eigen::Matrix3d edges;
    for (int k = 0; k < 3; ++k) {
      edges.col(k) = (mesh.nodes.row(mesh.tets(e, k + 1)) - mesh.nodes.row(mesh.tets(e, 0))).transpose();
    }
    const double volume = edges.determinant() / 6;
    Eigen::Matrix<double, 4, 3> gradients;  // of the hat functions
    gradients.bottomRows<3>() = edges.inverse();
    gradients.row(0) = -gradients.bottomRows<3>().colwise().sum();
    const Eigen::Matrix4d local = weights[static_cast<std::size_t>(e)] * volume * gradients * gradients.transpose();
    for (int a = 0; a < 4; ++a) {
      for (int b = 0; b < 4; ++b) entries.emplace_back(mesh.tets(e, a), mesh.tets(e, b), local(a, b));
    }
  }
  Eigen::SparseMatrix<double> laplacian(mesh.nodes.rows(), mesh.nodes.rows());
  laplacian.setFromTriplets(entries.begin(), entries.end());
  return laplacian;
}

}  // namespace bodyopt
