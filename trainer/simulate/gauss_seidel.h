// Sweeps of Gauss and Seidel over a sparse symmetric matrix, with several right sides in lanes.
#pragma once

#include <Eigen/SparseCore>
#include <vector>

namespace bodyopt::trainer {

class GaussSeidel {
 public:
  using Lanes = Eigen::Matrix<float, Eigen::Dynamic, 4, Eigen::RowMajor>;

  // matrix: symmetric with a positive diagonal, N x N. It is kept in single precision.
  explicit GaussSeidel(const Eigen::SparseMatrix<double>& matrix);

  // One sweep from zero: (D + L) values = right, N x 4.
  void forward(const Lanes& right, Lanes& values) const;
  // The residual that `forward` leaves: right - A values = -U values.
  void remainder(const Lanes& values, Lanes& result) const;
  // One sweep backwards, the transpose of `forward` where it starts from zero.
  void backward(const Lanes& right, Lanes& values) const;

 private:
  struct Triangle {
    std::vector<int> begin{0}, column;  // of rows, N + 1; of entries
    std::vector<float> value;

    // Subtracts this triangle's row times the values.
    void subtract(Eigen::Index row, const Lanes& values, Eigen::Array<float, 1, 4>& from) const;
  };
  Triangle lower_, upper_;
  std::vector<float> inverse_diagonal_;
};

}  // namespace bodyopt::trainer
