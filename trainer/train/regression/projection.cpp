#include "trainer/train/regression/projection.h"

#include <algorithm>

#include "base/linear_algebra.h"

namespace bodyopt {

using Eigen::Index;
using Eigen::MatrixXd;

namespace {

constexpr double kRidge = 1e-3;       // times the number of frames
constexpr double kLeastScale = 1e-2;  // of a coordinate, to the first: less is noise

}  // namespace

MatrixXd projection(const MatrixXd& features, const MatrixXd& targets) {
  if (features.cols() == 0) return {};
  const double frames = static_cast<double>(features.rows());
  MatrixXd normal = features.transpose() * features;
  normal.diagonal().array() += kRidge * frames;
  const MatrixXd map = Cholesky(normal).solve(features.transpose() * targets);
  // The map's singular values, ascending, are the roots of these; its left singular vectors are their vectors.
  const SymmetricEigen eigen = symmetric_eigen(map * map.transpose());
  const Eigen::VectorXd squares = eigen.values.cwiseMax(0).reverse();
  const Eigen::VectorXd scales = (squares / std::max(squares[0], 1e-300)).cwiseSqrt().cwiseSqrt();
  const Index count = (scales.array() > kLeastScale).count();
  const MatrixXd rows =
      (eigen.vectors.rowwise().reverse().leftCols(count) * scales.head(count).asDiagonal()).transpose();
  return rows.unaryExpr(&stored_half);
}

}  // namespace bodyopt
