#include "trainer/simulate/gauss_seidel.h"

namespace bodyopt::trainer {

GaussSeidel::GaussSeidel(const Eigen::SparseMatrix<double>& matrix) : inverse_diagonal_(matrix.rows()) {
  const auto add = [](Triangle& triangle, Eigen::Index column, double value) {
    triangle.column.push_back(static_cast<int>(column));
    triangle.value.push_back(static_cast<float>(value));
  };
  for (Eigen::Index row = 0; row < matrix.outerSize(); ++row) {  // columns are rows: it is symmetric
    for (Eigen::SparseMatrix<double>::InnerIterator entry(matrix, row); entry; ++entry) {
      if (entry.row() == row) {
        inverse_diagonal_[static_cast<std::size_t>(row)] = static_cast<float>(1 / entry.value());
      } else {
        add(entry.row() < row ? lower_ : upper_, entry.row(), entry.value());
      }
    }
    for (Triangle* triangle : {&lower_, &upper_}) triangle->begin.push_back(static_cast<int>(triangle->column.size()));
  }
}

void GaussSeidel::Triangle::subtract(Eigen::Index row, const Lanes& values, Eigen::Array<float, 1, 4>& from) const {
  const auto r = static_cast<std::size_t>(row);
  for (auto k = static_cast<std::size_t>(begin[r]); k < static_cast<std::size_t>(begin[r + 1]); ++k) {
    from -= value[k] * values.row(column[k]).array();
  }
}

void GaussSeidel::forward(const Lanes& right, Lanes& values) const {
  values.resize(right.rows(), 4);
  for (Eigen::Index row = 0; row < right.rows(); ++row) {
    Eigen::Array<float, 1, 4> sum = right.row(row).array();
    lower_.subtract(row, values, sum);
    values.row(row) = (inverse_diagonal_[static_cast<std::size_t>(row)] * sum).matrix();
  }
}

void GaussSeidel::remainder(const Lanes& values, Lanes& result) const {
  result.resize(values.rows(), 4);
  for (Eigen::Index row = 0; row < values.rows(); ++row) {
    Eigen::Array<float, 1, 4> sum = Eigen::Array<float, 1, 4>::Zero();
    upper_.subtract(row, values, sum);
    result.row(row) = sum.matrix();
  }
}

void GaussSeidel::backward(const Lanes& right, Lanes& values) const {
  for (Eigen::Index row = right.rows(); row-- > 0;) {
    Eigen::Array<float, 1, 4> sum = right.row(row).array();
    lower_.subtract(row, values, sum);
    upper_.subtract(row, values, sum);
    values.row(row) = (inverse_diagonal_[static_cast<std::size_t>(row)] * sum).matrix();
  }
}

}  // namespace bodyopt::trainer
