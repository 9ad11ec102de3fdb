#include "trainer/simulate/quadrature_points.h"

#include <cmath>
#include <map>
#include <utility>

namespace bodyopt::trainer {
namespace {

constexpr int kPoints = 4, kEighths = 8;
// Barycentric weights of a point: of the corner that it is near to, and of the others.
const double kNear = (5 + 3 * std::sqrt(5.0)) / 20, kFar = (5 - std::sqrt(5.0)) / 20;
// A point's tet has a quarter of the volume at this scale.
const double kScale = std::cbrt(0.25);
// dN / dw_a of corner a and of the middles next to it. `kTowards` is added for the middle towards the point's own
// corner, or for corner a where that is its own.
const double kCorner = kScale * (4 * kFar - 1), kMiddle = kScale * 4 * kFar, kTowards = kScale * 4 * (kNear - kFar);

double share(int point, int eighth) {
  if (eighth >= kPoints) return 0.5 / kPoints;
  return eighth == point ? 0.5 : 0;
}

}  // namespace

QuadraturePoints::QuadraturePoints(const TetMesh& eighths) : nodes_(eighths.tets.rows() / 2, 4) {
  for (Eigen::Index t = 0; t < nodes_.rows() / kPoints; ++t) {
    nodes_.middleRows<kPoints>(kPoints * t) = eighths.tets.middleRows<kPoints>(kEighths * t);
  }
}

Positions QuadraturePoints::corners(const Positions& nodes) const {
  Positions corners(4 * nodes_.rows(), 3);
  for (Eigen::Index t = 0; t < nodes_.rows() / kPoints; ++t) {
    for (int a = 0; a < 4; ++a) {
      const auto around = nodes_.row(kPoints * t + a);
      Eigen::RowVector3d common = Eigen::RowVector3d::Zero();
      for (int b = 0; b < 4; ++b) common += (b == a ? kCorner : kMiddle) * nodes.row(around[b]);
      for (int q = 0; q < kPoints; ++q) {
        corners.row(4 * (kPoints * t + q) + a) = common + kTowards * nodes.row(around[q]);
      }
    }
  }
  return corners;
}

void QuadraturePoints::add_gradient(const Positions& of_corners, Positions& gradient) const {
  for (Eigen::Index t = 0; t < nodes_.rows() / kPoints; ++t) {
    for (int a = 0; a < 4; ++a) {
      const auto around = nodes_.row(kPoints * t + a);
      Eigen::RowVector3d common = Eigen::RowVector3d::Zero();
      for (int q = 0; q < kPoints; ++q) common += of_corners.row(4 * (kPoints * t + q) + a);
      for (int b = 0; b < 4; ++b) {
        gradient.row(around[b]) +=
            (b == a ? kCorner : kMiddle) * common + kTowards * of_corners.row(4 * (kPoints * t + b) + a);
      }
    }
  }
}

TetMesh QuadraturePoints::tets(const TetMesh& eighths) const {
  TetMesh mesh;
  mesh.nodes = corners(eighths.nodes);
  mesh.tets.resize(nodes_.rows(), 4);
  for (Eigen::Index p = 0; p < mesh.tets.rows(); ++p) {
    for (int a = 0; a < 4; ++a) mesh.tets(p, a) = static_cast<int>(4 * p + a);
  }
  return mesh;
}

std::vector<TetMaterial> QuadraturePoints::of_points(const std::vector<TetMaterial>& eighths) {
  std::vector<TetMaterial> points(eighths.size() / 2);
  for (std::size_t p = 0; p < points.size(); ++p) {
    for (int e = 0; e < kEighths; ++e) {
      const TetMaterial& eighth = eighths[p / kPoints * kEighths + static_cast<std::size_t>(e)];
      points[p].mu += share(static_cast<int>(p % kPoints), e) * eighth.mu;
      points[p].lambda += share(static_cast<int>(p % kPoints), e) * eighth.lambda;
    }
  }
  return points;
}

std::vector<FibreTet> QuadraturePoints::of_points(const std::vector<FibreTet>& eighths) {
  std::map<std::pair<int, int>, FibreTet> sums;  // by point and muscle
  for (const FibreTet& fibre : eighths) {
    for (int q = 0; q < kPoints; ++q) {
      const double part = share(q, fibre.tet % kEighths) * fibre.share;
      if (part == 0) continue;
      const int point = fibre.tet / kEighths * kPoints + q;
      const FibreTet none{point, fibre.muscle, Eigen::Vector3d::Zero(), 0};
      FibreTet& sum = sums.try_emplace({point, fibre.muscle}, none).first->second;
      sum.direction += part * fibre.direction;
      sum.share += part;
    }
  }
  std::vector<FibreTet> points;
  for (auto& [key, fibre] : sums) {
    fibre.direction.normalize();
    points.push_back(fibre);
  }
  return points;
}

}  // namespace bodyopt::trainer
