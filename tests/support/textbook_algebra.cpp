#include "tests/support/textbook_algebra.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>

namespace bodyopt::testing {

Eigen::MatrixXd textbook_solve(const Eigen::MatrixXd& matrix, const Eigen::MatrixXd& right) {
  return matrix.colPivHouseholderQr().solve(right);
}

Eigen::VectorXd generalised_eigenvalues(const Eigen::MatrixXd& stiffness, const Eigen::MatrixXd& mass) {
  return Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd>(stiffness, mass, Eigen::EigenvaluesOnly)
      .eigenvalues();
}

}  // namespace bodyopt::testing
