// Linear algebra that tests compare with, compiled once.
#pragma once

#include <Eigen/Core>

namespace bodyopt::testing {

// The least-squares solution (K x M) of matrix (N x K) times it = right (N x M): by QR with pivots, of which the
// product knows nothing.
Eigen::MatrixXd textbook_solve(const Eigen::MatrixXd& matrix, const Eigen::MatrixXd& right);

// Ascending, of stiffness x = value mass x, both symmetric, mass positive definite.
Eigen::VectorXd generalised_eigenvalues(const Eigen::MatrixXd& stiffness, const Eigen::MatrixXd& mass);

struct TextbookSvd {
  Eigen::VectorXd values;  // descending
  Eigen::MatrixXd left;    // N x values: the left singular vectors
};
TextbookSvd textbook_svd(const Eigen::MatrixXd& matrix);  // N x K

}  // namespace bodyopt::testing
