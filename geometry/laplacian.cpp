#include "geometry/laplacian.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <vector>

namespace bodyopt {

Eigen::VectorXd lumped_areas(const Positions& rest, const Triangles& triangles) {
  Eigen::VectorXd areas = Eigen::VectorXd::Zero(rest.rows());
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    const Eigen::RowVector3d a = rest.row(triangles(t, 0)), b = rest.row(triangles(t, 1)),
                             c = rest.row(triangles(t, 2));
    const double third = (b - a).cross(c - a).norm() / 6;
    for (int k = 0; k < 3; ++k) areas[triangles(t, k)] += third;
  }
  const double mean = areas.size() > 0 ? areas.mean() : 0;
  return areas.cwiseMax(mean > 0 ? 1e-3 * mean : 1.0);
}

Eigen::SparseMatrix<double> cotangent_laplacian(const Positions& rest, const Triangles& triangles) {
  std::vector<Eigen::Triplet<double>> halves;  // half cotangents of directed edges, upper triangle
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const int corner = static_cast<int>(triangles(t, k)), i = static_cast<int>(triangles(t, (k + 1) % 3)),
                j = static_cast<int>(triangles(t, (k + 2) % 3));
      const Eigen::RowVector3d a = rest.row(i) - rest.row(corner), b = rest.row(j) - rest.row(corner);
      const double area = a.cross(b).norm();
      if (!(area > 1e-10 * std::max(a.squaredNorm(), b.squaredNorm()))) continue;
      halves.emplace_back(std::min(i, j), std::max(i, j), 0.5 * a.dot(b) / area);
    }
  }
  Eigen::SparseMatrix<double> edges(rest.rows(), rest.rows());
  edges.setFromTriplets(halves.begin(), halves.end());

  std::vector<Eigen::Triplet<double>> entries;
  for (int v = 0; v < static_cast<int>(rest.rows()); ++v) entries.emplace_back(v, v, 0.0);
  for (int column = 0; column < edges.outerSize(); ++column) {
    for (Eigen::SparseMatrix<double>::InnerIterator edge(edges, column); edge; ++edge) {
      const int i = static_cast<int>(edge.row()), j = static_cast<int>(edge.col());
      const double weight = std::max(0.0, edge.value());
      entries.emplace_back(i, j, -weight);
      entries.emplace_back(j, i, -weight);
      entries.emplace_back(i, i, weight);
      entries.emplace_back(j, j, weight);
    }
  }
  Eigen::SparseMatrix<double> laplacian(rest.rows(), rest.rows());
  laplacian.setFromTriplets(entries.begin(), entries.end());
  return laplacian;
}

namespace {

constexpr int kSmoothingSteps = 4;

}  // namespace

SkinSmoother::SkinSmoother(const Positions& rest, const Triangles& triangles, double radius)
    : areas_(lumped_areas(rest, triangles)) {
  Eigen::SparseMatrix<double> matrix = radius * radius / (2 * kSmoothingSteps) * cotangent_laplacian(rest, triangles);
  matrix.diagonal() += areas_;
  solver_ = SparseSolver(matrix);
}

Eigen::MatrixXd SkinSmoother::operator()(const Eigen::MatrixXd& values) const {
  Eigen::MatrixXd result = values;
  for (int step = 0; step < kSmoothingSteps; ++step) {
    const Eigen::MatrixXd right = areas_.asDiagonal() * result;  // solve() does not expect its result on both sides
    result = solver_.solve(right);
  }
  return result;
}

Eigen::MatrixXd smoothed(const Positions& rest, const Triangles& triangles, const Eigen::MatrixXd& values,
                         double radius) {
  return SkinSmoother(rest, triangles, radius)(values);
}

}  // namespace bodyopt
