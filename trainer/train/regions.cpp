#include "trainer/train/regions.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>

#include "trainer/train/laplacian.h"

namespace bodyopt {
namespace {

constexpr double kLength = 0.25;  // metres that count as much as a full change of joint
constexpr double kCover = 0.6;    // seeds are added until every vertex is this near to one
constexpr std::size_t kMostRegions = 40;
constexpr double kSmoothing = 0.03;    // metres
constexpr double kLeastWeight = 0.02;  // smaller weights are dropped

using Points = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// Position and skin weights of each vertex as one point.
Points embed(const Character& character, double scale) {
  const Eigen::Index joints = static_cast<Eigen::Index>(character.skeleton.size());
  Points points = Points::Zero(character.vertices.rows(), 3 + joints);
  points.leftCols<3>() = character.vertices / (kLength * scale);
  for (Eigen::Index v = 0; v < points.rows(); ++v) {
    for (const JointWeight& w : character.weights[static_cast<std::size_t>(v)]) {
      points(v, 3 + static_cast<Eigen::Index>(w.joint)) += w.weight;
    }
  }
  return points;
}

// Squared distances of all points to each of the seeds, seeds by farthest-point sampling. V x seeds
Eigen::MatrixXd seed_distances(const Points& points) {
  std::vector<Eigen::VectorXd> columns;
  Eigen::Index seed = 0;
  Eigen::VectorXd nearest = (points.rowwise() - points.colwise().mean()).rowwise().squaredNorm();
  nearest.maxCoeff(&seed);
  do {
    columns.emplace_back((points.rowwise() - points.row(seed)).rowwise().squaredNorm());
    nearest = columns.size() == 1 ? columns[0] : Eigen::VectorXd(nearest.cwiseMin(columns.back()));
  } while (nearest.maxCoeff(&seed) > kCover * kCover && columns.size() < kMostRegions);
  Eigen::MatrixXd distances(points.rows(), static_cast<Eigen::Index>(columns.size()));
  for (std::size_t r = 0; r < columns.size(); ++r) distances.col(static_cast<Eigen::Index>(r)) = columns[r];
  return distances;
}

void normalise_rows(Eigen::MatrixXd& weights) {
  for (Eigen::Index v = 0; v < weights.rows(); ++v) weights.row(v) /= weights.row(v).sum();
}

Eigen::MatrixXd smooth(const Character& character, const Eigen::MatrixXd& weights, double radius) {
  const Eigen::VectorXd areas = lumped_areas(character.vertices, character.triangles);
  Eigen::SparseMatrix<double> matrix =
      0.5 * radius * radius * cotangent_laplacian(character.vertices, character.triangles);
  matrix.diagonal() += areas;
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(matrix);
  const Eigen::MatrixXd right = areas.asDiagonal() * weights;
  return solver.solve(right);
}

}  // namespace

double body_scale(const Positions& rest) {
  const double size = (rest.colwise().maxCoeff() - rest.colwise().minCoeff()).maxCoeff();
  return size > 0 ? size / std::clamp(size, 0.5, 1.8) : 1;
}

std::vector<SoftRegion> soft_regions(const Character& character) {
  const double scale = body_scale(character.vertices);
  const Eigen::MatrixXd distances = seed_distances(embed(character, scale));
  // Relative to the nearest seed, so that far vertices do not underflow.
  const Eigen::VectorXd nearest = distances.rowwise().minCoeff();
  Eigen::MatrixXd weights = (-(distances.colwise() - nearest).array() / (0.5 * kCover * kCover)).exp().matrix();
  normalise_rows(weights);
  weights = smooth(character, weights, kSmoothing * scale);
  for (Eigen::Index v = 0; v < weights.rows(); ++v) {
    const double largest = weights.row(v).maxCoeff();
    for (double& w : weights.row(v)) w = w < kLeastWeight && w < largest ? 0 : w;
  }
  normalise_rows(weights);

  std::vector<SoftRegion> regions;
  for (Eigen::Index r = 0; r < weights.cols(); ++r) {
    SoftRegion region;
    double sum = 0;
    for (Eigen::Index v = 0; v < weights.rows(); ++v) {
      if (weights(v, r) == 0) continue;
      region.vertices.push_back(static_cast<std::uint32_t>(v));
      region.weights.push_back(static_cast<float>(weights(v, r)));
      region.centre += weights(v, r) * character.vertices.row(v).transpose();
      sum += weights(v, r);
    }
    if (region.vertices.empty()) continue;
    region.centre /= sum;
    regions.push_back(std::move(region));
  }
  return regions;
}

}  // namespace bodyopt
