#include "trainer/tets/thickness.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "trainer/train/parallel.h"

namespace bodyopt {
namespace {

constexpr double kThinnest = 1.0 / 180, kThickest = 1.0 / 6;  // of the body's extent
// Thickness is averaged within about this part of the extent: a ray alone sees every ear and finger.
constexpr double kNearby = 0.04;
constexpr int kMostRounds = 200;

struct Corners {
  Eigen::Vector3d origin, first, second;  // a corner, and the edges from it
};

// Distance along a ray of unit direction to a triangle; infinite where it misses (Moeller, Trumbore 1997).
double hit(const Corners& triangle, const Eigen::Vector3d& origin, const Eigen::Vector3d& along) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  const Eigen::Vector3d p = along.cross(triangle.second);
  const double determinant = triangle.first.dot(p);
  if (determinant == 0) return kNone;
  const Eigen::Vector3d s = origin - triangle.origin;
  const double u = s.dot(p) / determinant;
  if (!(u >= 0 && u <= 1)) return kNone;
  const Eigen::Vector3d q = s.cross(triangle.first);
  const double v = along.dot(q) / determinant, distance = triangle.second.dot(q) / determinant;
  return v >= 0 && u + v <= 1 && distance > 0 ? distance : kNone;
}

double mean_edge(const Positions& vertices, const Triangles& triangles) {
  double sum = 0;
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) sum += (vertices.row(triangles(t, k)) - vertices.row(triangles(t, (k + 1) % 3))).norm();
  }
  return sum / (3.0 * static_cast<double>(triangles.rows()));
}

// Each round averages over a vertex and its neighbours and so widens the average by about an edge's square.
void smooth(const Triangles& triangles, double rounds, Eigen::VectorXd& values) {
  for (int k = 0; k < static_cast<int>(std::clamp(rounds, 1.0, static_cast<double>(kMostRounds))); ++k) {
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(values.size()), count = Eigen::VectorXd::Zero(values.size());
    for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
      for (int a = 0; a < 3; ++a) {
        sum[triangles(t, a)] += values[triangles(t, 0)] + values[triangles(t, 1)] + values[triangles(t, 2)];
        count[triangles(t, a)] += 3;
      }
    }
    for (Eigen::Index v = 0; v < values.size(); ++v) values[v] = count[v] > 0 ? sum[v] / count[v] : values[v];
  }
}

}  // namespace

Positions vertex_normals(const Positions& vertices, const Triangles& triangles) {
  Positions normals = Positions::Zero(vertices.rows(), 3);
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    const Eigen::Vector3d a = vertices.row(triangles(t, 0)), b = vertices.row(triangles(t, 1)),
                          c = vertices.row(triangles(t, 2));
    const Eigen::RowVector3d normal = (b - a).cross(c - a).transpose();
    for (int k = 0; k < 3; ++k) normals.row(triangles(t, k)) += normal;
  }
  return normals.rowwise().normalized();
}

Eigen::VectorXd thickness(const Positions& vertices, const Triangles& triangles) {
  const Positions normals = vertex_normals(vertices, triangles);
  std::vector<Corners> corners;
  std::vector<double> radius2;
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    const Eigen::Vector3d a = vertices.row(triangles(t, 0)), b = vertices.row(triangles(t, 1)),
                          c = vertices.row(triangles(t, 2));
    corners.push_back({a, b - a, c - a});
    radius2.push_back(std::max((b - a).squaredNorm(), (c - a).squaredNorm()));
  }
  const double extent = (vertices.colwise().maxCoeff() - vertices.colwise().minCoeff()).maxCoeff();
  Eigen::VectorXd result(vertices.rows());
  parallel_for(static_cast<std::size_t>(vertices.rows()), [&](std::size_t n) {
    const auto v = static_cast<Eigen::Index>(n);
    const Eigen::Vector3d origin = vertices.row(v), along = -normals.row(v);
    double nearest = kThickest * extent;
    for (std::size_t t = 0; t < corners.size(); ++t) {
      const auto of = triangles.row(static_cast<Eigen::Index>(t)).cast<Eigen::Index>();
      if (of[0] == v || of[1] == v || of[2] == v) continue;
      const Eigen::Vector3d to = corners[t].origin - origin;
      const double ahead = to.dot(along);
      if (to.squaredNorm() - ahead * ahead > radius2[t]) continue;  // the ray passes by
      nearest = std::min(nearest, hit(corners[t], origin, along));
    }
    result[v] = std::max(nearest, kThinnest * extent);
  });
  smooth(triangles, std::pow(kNearby * extent / mean_edge(vertices, triangles), 2), result);
  return result;
}

}  // namespace bodyopt
