#include "trainer/train/components.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <random>

namespace bodyopt {
namespace {

constexpr Eigen::Index kOversampling = 10;
constexpr int kIterations = 6;

Eigen::MatrixXd orthonormal(const Eigen::MatrixXd& columns) {
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(columns);
  return qr.householderQ() * Eigen::MatrixXd::Identity(columns.rows(), columns.cols());
}

// Rows of a random orthonormal block, moved towards the largest left singular vectors of targets.
Eigen::MatrixXd dominant_space(const FrameRows& targets, Eigen::Index width, std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal;
  Eigen::MatrixXd block(targets.rows(), width);
  for (double& value : block.reshaped()) value = normal(generator);
  block = orthonormal(block);
  for (int k = 0; k < kIterations && width < targets.rows(); ++k) {
    const Eigen::MatrixXf across = targets.transpose() * block.cast<float>();
    const Eigen::MatrixXf back = targets * across;
    block = orthonormal(back.cast<double>());
  }
  return block;
}

}  // namespace

Components principal_components(const FrameRows& targets, int most, double least, std::uint64_t seed) {
  const Eigen::Index limit = std::min({targets.rows(), targets.cols(), Eigen::Index{most}});
  const Eigen::Index width = std::min({targets.rows(), targets.cols(), limit + kOversampling});
  if (limit == 0) return {Eigen::MatrixXf(targets.cols(), 0), Eigen::MatrixXd(targets.rows(), 0)};
  const Eigen::MatrixXd space = dominant_space(targets, width, seed);
  const Eigen::MatrixXd across = (targets.transpose() * space.cast<float>()).cast<double>();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(across.transpose() * across);  // ascending
  const double floor = least * std::sqrt(static_cast<double>(targets.rows()));
  const auto singular = [&](Eigen::Index k) { return std::sqrt(std::max(0.0, eigen.eigenvalues()[width - 1 - k])); };
  Eigen::Index count = 0;
  while (count < limit && singular(count) > std::max(floor, 1e-6 * singular(0))) ++count;

  Components result{Eigen::MatrixXf(targets.cols(), count), Eigen::MatrixXd(targets.rows(), count)};
  for (Eigen::Index k = 0; k < count; ++k) {
    const Eigen::VectorXd vector = eigen.eigenvectors().col(width - 1 - k);
    result.directions.col(k) = (across * vector / singular(k)).cast<float>();
    result.coefficients.col(k) = space * vector * singular(k);
  }
  return result;
}

}  // namespace bodyopt
