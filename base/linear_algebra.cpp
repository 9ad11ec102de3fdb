#include "base/linear_algebra.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <Eigen/SparseCholesky>

namespace bodyopt {

SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& matrix) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(matrix);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

SymmetricEigen3 symmetric_eigen_3(const Eigen::Matrix3d& matrix) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(matrix);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

Eigen::MatrixXd orthonormal_basis(const Eigen::MatrixXd& columns, double least) {
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(columns);
  qr.setThreshold(least);
  return qr.householderQ() * Eigen::MatrixXd::Identity(columns.rows(), qr.rank());
}

Cholesky::Cholesky(Eigen::MatrixXd matrix) : lower_(std::move(matrix)) {
  is_positive_ = Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>>(lower_).info() == Eigen::Success;
}

void Cholesky::solve_in_place(Eigen::MatrixXd& values) const {
  const auto lower = lower_.triangularView<Eigen::Lower>();
  lower.solveInPlace(values);
  lower.adjoint().solveInPlace(values);
}

void Cholesky::solve_in_place(Eigen::VectorXd& values) const {
  const auto lower = lower_.triangularView<Eigen::Lower>();
  lower.solveInPlace(values);
  lower.adjoint().solveInPlace(values);
}

struct SparseSolver::Factor {
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> of;
};

SparseSolver::SparseSolver() = default;
SparseSolver::SparseSolver(const Eigen::SparseMatrix<double>& matrix)
    : factor_(new Factor{Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>(matrix)}) {}
SparseSolver::SparseSolver(SparseSolver&&) noexcept = default;
SparseSolver& SparseSolver::operator=(SparseSolver&&) noexcept = default;
SparseSolver::~SparseSolver() = default;

bool SparseSolver::is_solvable() const { return factor_ && factor_->of.info() == Eigen::Success; }

Eigen::MatrixXd SparseSolver::solve_columns(const Eigen::MatrixXd& right) const { return factor_->of.solve(right); }

}  // namespace bodyopt
