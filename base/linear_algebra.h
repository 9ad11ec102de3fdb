// Solvers of linear algebra, compiled once: Eigen's templates for them cost seconds wherever they are named.
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <memory>
#include <type_traits>

namespace bodyopt {

// Eigenvalues of a symmetric matrix, whose lower half is read, ascend; eigenvectors are orthonormal columns.
struct SymmetricEigen {
  Eigen::VectorXd values;
  Eigen::MatrixXd vectors;
};
SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& matrix);

// The eigensystem of a symmetric 3 x 3 matrix, as above, is found without allocation.
struct SymmetricEigen3 {
  Eigen::Vector3d values;
  Eigen::Matrix3d vectors;
};
SymmetricEigen3 symmetric_eigen_3(const Eigen::Matrix3d& matrix);

// An orthonormal basis (N x rank) of the span of columns (N x K). A column's remainder without its share in others
// counts as nothing if it is less than `least` of the largest.
Eigen::MatrixXd orthonormal_basis(const Eigen::MatrixXd& columns, double least);

// The factor L L^T of a symmetric matrix (N x N), whose lower half is read.
class Cholesky {
 public:
  Cholesky() = default;  // of no matrix
  explicit Cholesky(Eigen::MatrixXd matrix);

  bool is_positive() const { return is_positive_; }        // otherwise nothing can be solved
  const Eigen::MatrixXd& lower() const { return lower_; }  // what stands above its diagonal is the matrix's
  // N or N x any. Any thread may call it.
  template <typename Right>
  auto solve(const Eigen::MatrixBase<Right>& right) const {
    std::conditional_t<Right::ColsAtCompileTime == 1, Eigen::VectorXd, Eigen::MatrixXd> values = right;
    solve_in_place(values);
    return values;
  }

 private:
  void solve_in_place(Eigen::MatrixXd& values) const;
  void solve_in_place(Eigen::VectorXd& values) const;

  Eigen::MatrixXd lower_;
  bool is_positive_ = false;
};

// The sum of the entries at each place.
inline Eigen::SparseMatrix<double> sparse_matrix(Eigen::Index rows, Eigen::Index columns,
                                                 const std::vector<Eigen::Triplet<double>>& entries) {
  Eigen::SparseMatrix<double> matrix(rows, columns);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

// The factor L D L^T of a sparse symmetric matrix (N x N), whose lower half is read.
class SparseSolver {
 public:
  SparseSolver();  // of no matrix
  explicit SparseSolver(const Eigen::SparseMatrix<double>& matrix);
  SparseSolver(SparseSolver&&) noexcept;
  SparseSolver& operator=(SparseSolver&&) noexcept;
  ~SparseSolver();

  bool is_solvable() const;  // no pivot is zero
  // N or N x any. Any thread may call it.
  template <typename Right>
  typename Right::PlainObject solve(const Eigen::MatrixBase<Right>& right) const {
    return solve_columns(right);
  }

 private:
  Eigen::MatrixXd solve_columns(const Eigen::MatrixXd& right) const;

  struct Factor;
  std::unique_ptr<const Factor> factor_;
};

}  // namespace bodyopt
