#include "trainer/dynamics/core_springs.h"

#include <algorithm>

namespace bodyopt {
namespace {

constexpr double kFullyHeld = 1.25;  // times `flesh`

double blended(const Eigen::VectorXd& values, const Tets& tets, const EmbeddedPoint& point) {
  double sum = 0;
  for (int a = 0; a < 4; ++a) sum += point.weights[a] * values[tets(point.tet, a)];
  return sum;
}

}  // namespace

SparseMatrix core_springs(const Positions& vertices, const Triangles& triangles, const Cage& cage,
                          const Eigen::VectorXd& flesh, double stiffness) {
  const NearestSkin nearest(vertices, triangles);
  const TetMesh& mesh = cage.mesh;
  const auto position = [&](const EmbeddedPoint& point) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (int a = 0; a < 4; ++a) sum += point.weights[a] * mesh.nodes.row(mesh.tets(point.tet, a)).transpose();
    return sum;
  };
  const auto depth = [&](const Eigen::Vector3d& at) { return (nearest(at).position - at).norm(); };
  std::vector<Eigen::Triplet<double>> entries;
  int tet = -1;
  bool is_shallow = false;  // all of the tet
  for (const CageSample& sample : cage.samples) {
    const EmbeddedPoint& point = sample.point;
    const double from = blended(flesh, mesh.tets, point);
    if (point.tet != tet) {
      tet = point.tet;
      const Eigen::Vector3d middle = position({tet, Eigen::Vector4d::Constant(0.25)});
      double reach = 0;
      for (int a = 0; a < 4; ++a) {
        reach = std::max(reach, (mesh.nodes.row(mesh.tets(tet, a)).transpose() - middle).norm());
      }
      double least = from;
      for (int a = 0; a < 4; ++a) least = std::min(least, flesh[mesh.tets(tet, a)]);
      is_shallow = depth(middle) + reach < least;
    }
    if (is_shallow) continue;
    const double held = std::clamp((depth(position(point)) / from - 1) / (kFullyHeld - 1), 0.0, 1.0);
    if (held == 0) continue;
    for (int a = 0; a < 4; ++a) {
      for (int b = 0; b < 4; ++b) {
        entries.emplace_back(mesh.tets(tet, a), mesh.tets(tet, b),
                             stiffness * held * sample.volume * point.weights[a] * point.weights[b]);
      }
    }
  }
  SparseMatrix springs(mesh.nodes.rows(), mesh.nodes.rows());
  springs.setFromTriplets(entries.begin(), entries.end());
  return springs;
}

}  // namespace bodyopt
