#include "trainer/builtin/weights.h"

#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>
#include <algorithm>

namespace bodyopt {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr int kSteps = 4;  // implicit steps: one alone has a sharp peak, four are close to a Gaussian
constexpr std::size_t kInfluences = 6;
constexpr double kSmallest = 2e-3;  // weights below are dropped

std::vector<int> nearest_regions(const Positions& vertices, const std::vector<JointRegion>& regions) {
  std::vector<int> nearest;
  for (Eigen::Index v = 0; v < vertices.rows(); ++v) {
    const Vector3d point = vertices.row(v);
    std::vector<double> distances;
    for (const JointRegion& region : regions) distances.push_back(region.solid.distance(point));
    nearest.push_back(static_cast<int>(std::min_element(distances.begin(), distances.end()) - distances.begin()));
  }
  return nearest;
}

struct Heat {
  VectorXd areas;                      // lumped, m^2
  Eigen::SparseMatrix<double> matrix;  // areas + time step times Laplacian with the regions' conductivities
};

Heat heat_step(const Positions& vertices, const Triangles& triangles, const VectorXd& softness) {
  Heat heat;
  heat.areas = VectorXd::Zero(vertices.rows());
  std::vector<Eigen::Triplet<double>> entries;
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t a = triangles(t, k), b = triangles(t, (k + 1) % 3), c = triangles(t, (k + 2) % 3);
      const Vector3d u = vertices.row(a) - vertices.row(c), v = vertices.row(b) - vertices.row(c);
      const double twice_area = u.cross(v).norm();
      heat.areas[c] += twice_area / 6;
      const double time = 0.25 * (softness[a] * softness[a] + softness[b] * softness[b]) / kSteps;
      const double flow = time * 0.5 * std::max(u.dot(v), 0.0) / twice_area;
      entries.insert(entries.end(), {{static_cast<int>(a), static_cast<int>(b), -flow},
                                     {static_cast<int>(b), static_cast<int>(a), -flow},
                                     {static_cast<int>(a), static_cast<int>(a), flow},
                                     {static_cast<int>(b), static_cast<int>(b), flow}});
    }
  }
  for (Eigen::Index v = 0; v < vertices.rows(); ++v) {
    entries.emplace_back(static_cast<int>(v), static_cast<int>(v), heat.areas[v]);
  }
  heat.matrix.resize(vertices.rows(), vertices.rows());
  heat.matrix.setFromTriplets(entries.begin(), entries.end());
  return heat;
}

std::vector<JointWeight> strongest(const VectorXd& row) {
  std::vector<JointWeight> weights;
  for (Eigen::Index j = 0; j < row.size(); ++j) {
    if (row[j] >= kSmallest) weights.push_back({static_cast<std::uint32_t>(j), row[j]});
  }
  std::stable_sort(weights.begin(), weights.end(), [](const auto& a, const auto& b) { return a.weight > b.weight; });
  if (weights.size() > kInfluences) weights.resize(kInfluences);
  double sum = 0;
  for (const JointWeight& w : weights) sum += w.weight;
  for (JointWeight& w : weights) w.weight /= sum;
  return weights;
}

}  // namespace

std::vector<std::vector<JointWeight>> diffuse_weights(const Positions& vertices, const Triangles& triangles,
                                                      const std::vector<JointRegion>& regions) {
  const std::vector<int> nearest = nearest_regions(vertices, regions);
  MatrixXd amounts = MatrixXd::Zero(vertices.rows(), static_cast<Eigen::Index>(regions.size()));
  VectorXd softness(vertices.rows());
  for (Eigen::Index v = 0; v < vertices.rows(); ++v) {
    amounts(v, nearest[v]) = 1;
    softness[v] = regions[nearest[v]].softness;
  }
  const Heat heat = heat_step(vertices, triangles, softness);
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(heat.matrix);
  for (int step = 0; step < kSteps; ++step) {
    const MatrixXd heats = heat.areas.asDiagonal() * amounts;
    amounts = solver.solve(heats);
  }
  std::vector<std::vector<JointWeight>> weights;
  for (Eigen::Index v = 0; v < vertices.rows(); ++v) weights.push_back(strongest(amounts.row(v)));
  return weights;
}

}  // namespace bodyopt
