#include "trainer/train/regression/projection.h"

#include <Eigen/Cholesky>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "trainer/train/regression/stored_half.h"

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
  const MatrixXd map = normal.llt().solve(features.transpose() * targets);
  const Eigen::BDCSVD<MatrixXd> svd(map, Eigen::ComputeThinU);
  const Eigen::VectorXd scales = (svd.singularValues() / std::max(svd.singularValues()[0], 1e-300)).cwiseSqrt();
  const Index count = (scales.array() > kLeastScale).count();
  const MatrixXd rows = (svd.matrixU().leftCols(count) * scales.head(count).asDiagonal()).transpose();
  return rows.unaryExpr(&stored_half);
}

}  // namespace bodyopt
