#include "trainer/simulate/muscle_fibres.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace bodyopt {
namespace {

constexpr double kFullShortening = 0.2;

// A muscle's path at rest, with the arc length at each point.
struct Path {
  std::vector<Eigen::Vector3d> points;
  std::vector<double> arc;
  double radius = 0;
};

Path rest_path(const Muscle& muscle) {
  Path path;
  path.radius = muscle.radius;
  for (const MusclePoint& point : muscle.path) {
    const Eigen::Vector3d p(point.position[0], point.position[1], point.position[2]);
    path.arc.push_back(path.points.empty() ? 0 : path.arc.back() + (p - path.points.back()).norm());
    path.points.push_back(p);
  }
  return path;
}

struct Nearest {
  double relative = 2;  // distance over the belly's radius there
  Eigen::Vector3d direction;
};

Nearest nearest_on(const Path& path, const Eigen::Vector3d& point) {
  Nearest best;
  for (std::size_t k = 0; k + 1 < path.points.size(); ++k) {
    const Eigen::Vector3d edge = path.points[k + 1] - path.points[k];
    const double length = edge.norm();
    if (!(length > 0)) continue;
    const double along = std::clamp((point - path.points[k]).dot(edge) / (length * length), 0.0, 1.0);
    const double u = (path.arc[k] + along * length) / path.arc.back();
    const double belly = path.radius * std::sqrt(std::max(std::sin(std::numbers::pi * u), 0.0));
    const double distance = (path.points[k] + along * edge - point).norm();
    if (distance < best.relative * belly) best = {distance / belly, edge / length};
  }
  return best;
}

}  // namespace

std::vector<FibreTet> label_muscles(const TetMesh& mesh, const std::vector<Muscle>& muscles) {
  std::vector<Path> paths;
  for (const Muscle& muscle : muscles) paths.push_back(rest_path(muscle));
  std::vector<FibreTet> fibres;
  for (int t = 0; t < mesh.tets.rows(); ++t) {
    Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
    for (int a = 0; a < 4; ++a) centroid += 0.25 * mesh.nodes.row(mesh.tets(t, a)).transpose();
    double best = 1;
    FibreTet fibre{t, -1, Eigen::Vector3d::Zero()};
    for (std::size_t m = 0; m < paths.size(); ++m) {
      const Nearest nearest = nearest_on(paths[m], centroid);
      if (nearest.relative >= best) continue;
      best = nearest.relative;
      fibre.muscle = static_cast<int>(m);
      fibre.direction = nearest.direction;
    }
    if (fibre.muscle >= 0) fibres.push_back(fibre);
  }
  return fibres;
}

double path_length(const Muscle& muscle, std::span<const Affine> skinning) {
  double total = 0;
  for (std::size_t k = 0; k + 1 < muscle.path.size(); ++k) {
    const MusclePoint &a = muscle.path[k], &b = muscle.path[k + 1];
    total += length(skinning[b.joint] * b.position - skinning[a.joint] * a.position);
  }
  return total;
}

std::vector<double> activations(const std::vector<Muscle>& muscles, std::span<const Affine> skinning) {
  std::vector<double> result;
  for (const Muscle& muscle : muscles) {
    const double rest = rest_path(muscle).arc.back();
    const double shortening = rest > 0 ? 1 - path_length(muscle, skinning) / rest : 0;
    const double u = std::clamp(shortening / kFullShortening, 0.0, 1.0);
    result.push_back(muscle.max_activation * u * u * (3 - 2 * u));
  }
  return result;
}

}  // namespace bodyopt
