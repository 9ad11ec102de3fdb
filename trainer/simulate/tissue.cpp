#include "trainer/simulate/tissue.h"

#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "trainer/simulate/laplacian.h"
#include "trainer/simulate/materials.h"

namespace bodyopt {
namespace {

Eigen::Vector3d to_eigen(const Vec3& v) { return {v[0], v[1], v[2]}; }

Eigen::Vector3d centroid(const TetMesh& mesh, Eigen::Index tet) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int k = 0; k < 4; ++k) sum += mesh.nodes.row(mesh.tets(tet, k)).transpose();
  return sum / 4;
}

// The point of a polyline nearest to x: distance, relative arc length, direction.
struct NearestOnPath {
  double distance = 1e300, along = 0;
  Eigen::Vector3d tangent = Eigen::Vector3d::Zero();
};

NearestOnPath nearest_on_path(const Muscle& muscle, const Eigen::Vector3d& x) {
  NearestOnPath best;
  double total = 0;
  for (std::size_t k = 1; k < muscle.path.size(); ++k) {
    const Eigen::Vector3d a = to_eigen(muscle.path[k - 1].position), b = to_eigen(muscle.path[k].position);
    const double size = (b - a).norm();
    if (size < 1e-9) continue;
    const double t = std::clamp((x - a).dot(b - a) / (size * size), 0.0, 1.0);
    const double distance = (a + t * (b - a) - x).norm();
    if (distance < best.distance) best = {distance, total + t * size, (b - a) / size};
    total += size;
  }
  best.along /= total;
  return best;
}

double belly_radius(const Muscle& muscle, double along) {
  constexpr double kEnd = 0.35;  // of the belly's radius, where the muscle becomes tendon
  const double profile = std::sqrt(std::max(0.0, std::sin(std::numbers::pi * along)));
  return muscle.radius * std::max(kEnd, profile);
}

}  // namespace

Tissue label_tissue(const TetMesh& mesh, const std::vector<Muscle>& muscles) {
  Tissue tissue;
  tissue.muscle.assign(static_cast<std::size_t>(mesh.tets.rows()), -1);
  tissue.fibre.assign(static_cast<std::size_t>(mesh.tets.rows()), Eigen::Vector3d::Zero());
  for (Eigen::Index e = 0; e < mesh.tets.rows(); ++e) {
    const Eigen::Vector3d x = centroid(mesh, e);
    double best = 1;
    for (std::size_t m = 0; m < muscles.size(); ++m) {
      const NearestOnPath near = nearest_on_path(muscles[m], x);
      const double relative = near.distance / belly_radius(muscles[m], near.along);
      if (relative >= best) continue;
      best = relative;
      tissue.muscle[static_cast<std::size_t>(e)] = static_cast<int>(m);
      tissue.fibre[static_cast<std::size_t>(e)] = near.tangent;
    }
  }
  return tissue;
}

double path_length(const Muscle& muscle, const std::vector<Affine>& skinning) {
  double total = 0;
  for (std::size_t k = 1; k < muscle.path.size(); ++k) {
    const MusclePoint &a = muscle.path[k - 1], &b = muscle.path[k];
    total += length(skinning[b.joint] * b.position - skinning[a.joint] * a.position);
  }
  return total;
}

std::vector<double> activations(const std::vector<Muscle>& muscles, const std::vector<Affine>& skinning) {
  const std::vector<Affine> rest(skinning.size());
  std::vector<double> result;
  for (const Muscle& muscle : muscles) {
    const double shortening = std::max(0.0, 1 - path_length(muscle, skinning) / path_length(muscle, rest));
    const double x = shortening / kFullyActiveAt;
    result.push_back(muscle.max_activation * (1 - std::exp(-x * x)));
  }
  return result;
}

Eigen::MatrixXd interior_weights(const TetMesh& mesh, const Character& character) {
  const Eigen::Index nodes = mesh.nodes.rows(), skin = character.vertices.rows(), inside = nodes - skin;
  Eigen::MatrixXd weights = Eigen::MatrixXd::Zero(nodes, static_cast<Eigen::Index>(character.skeleton.size()));
  for (Eigen::Index v = 0; v < skin; ++v) {
    for (const JointWeight& w : character.weights[static_cast<std::size_t>(v)]) weights(v, w.joint) += w.weight;
  }
  if (inside == 0) return weights;
  const Eigen::SparseMatrix<double> laplacian =
      tet_laplacian(mesh, std::vector<double>(static_cast<std::size_t>(mesh.tets.rows()), 1.0));
  const Eigen::SparseMatrix<double> interior = laplacian.bottomRightCorner(inside, inside);
  const Eigen::SparseMatrix<double> boundary = laplacian.bottomLeftCorner(inside, skin);
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(interior);
  Eigen::MatrixXd solved = factor.solve(-(boundary * weights.topRows(skin)));
  solved = solved.cwiseMax(0.0);
  for (Eigen::Index n = 0; n < inside; ++n) weights.row(skin + n) = solved.row(n) / solved.row(n).sum();
  return weights;
}

}  // namespace bodyopt
