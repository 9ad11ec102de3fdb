#include "trainer/simulate/muscle_fibres.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "runtime/core/error.h"

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

std::vector<Path> rest_paths(const std::vector<Muscle>& muscles) {
  std::vector<Path> paths;
  for (const Muscle& muscle : muscles) paths.push_back(rest_path(muscle));
  return paths;
}

struct Fibre {
  int muscle = -1;  // none
  Eigen::Vector3d direction = Eigen::Vector3d::Zero();
};

Fibre fibre_at(const std::vector<Path>& paths, const Eigen::Vector3d& point) {
  double best = 1;
  Fibre fibre;
  for (std::size_t m = 0; m < paths.size(); ++m) {
    const Nearest nearest = nearest_on(paths[m], point);
    if (nearest.relative >= best) continue;
    best = nearest.relative;
    fibre = {static_cast<int>(m), nearest.direction};
  }
  return fibre;
}

struct PathMiddle {
  Eigen::Vector3d position, direction;
};

// Half way along a path of any length.
PathMiddle middle_of(const Path& path) {
  const double half = path.arc.back() / 2;
  std::size_t k = 0;
  while (path.arc[k + 1] < half) ++k;
  const Eigen::Vector3d along = (path.points[k + 1] - path.points[k]) / (path.arc[k + 1] - path.arc[k]);
  return {path.points[k] + (half - path.arc[k]) * along, along};
}

// Of a belly of radius sqrt(sin(pi u)), cubic metres.
double belly_volume(const Path& path) { return 2 * path.radius * path.radius * path.arc.back(); }

struct TetPlace {
  int tet;
  Eigen::Vector3d position;
};

// Adds what muscles that no tet fell to have of the tet next to their middle.
void add_thin_muscles(const std::vector<Path>& paths, const TetMesh& mesh, const std::vector<TetPlace>& places,
                      std::vector<FibreTet>& fibres) {
  std::vector<bool> fills(paths.size(), false);
  for (const FibreTet& fibre : fibres) fills[static_cast<std::size_t>(fibre.muscle)] = true;
  for (std::size_t m = 0; m < paths.size() && !places.empty(); ++m) {
    if (fills[m] || !(paths[m].arc.back() > 0)) continue;
    const PathMiddle middle = middle_of(paths[m]);
    const auto nearest = std::min_element(places.begin(), places.end(), [&](const TetPlace& a, const TetPlace& b) {
      return (a.position - middle.position).squaredNorm() < (b.position - middle.position).squaredNorm();
    });
    const double share = belly_volume(paths[m]) / (tet_edges(mesh, nearest->tet).determinant() / 6);
    fibres.push_back({nearest->tet, static_cast<int>(m), middle.direction, std::min(share, 1.0)});
  }
}

}  // namespace

std::vector<FibreTet> label_muscles(const TetMesh& mesh, const std::vector<Muscle>& muscles) {
  const std::vector<Path> paths = rest_paths(muscles);
  std::vector<FibreTet> fibres;
  std::vector<TetPlace> centroids;
  for (int t = 0; t < mesh.tets.rows(); ++t) {
    Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
    for (int a = 0; a < 4; ++a) centroid += 0.25 * mesh.nodes.row(mesh.tets(t, a)).transpose();
    const Fibre fibre = fibre_at(paths, centroid);
    if (fibre.muscle >= 0) fibres.push_back({t, fibre.muscle, fibre.direction});
    centroids.push_back({t, centroid});
  }
  add_thin_muscles(paths, mesh, centroids, fibres);
  return fibres;
}

std::vector<FibreTet> label_muscles(const Cage& cage, const std::vector<Muscle>& muscles) {
  struct Sum {
    double volume = 0;
    Eigen::Vector3d direction = Eigen::Vector3d::Zero();
  };
  const std::vector<Path> paths = rest_paths(muscles);
  std::map<std::pair<int, int>, Sum> sums;  // by tet and muscle
  std::vector<TetPlace> places;
  for (const CageSample& sample : cage.samples) {
    places.push_back({sample.point.tet, rest_position(cage.mesh, sample.point)});
    const Fibre fibre = fibre_at(paths, places.back().position);
    if (fibre.muscle < 0) continue;
    Sum& sum = sums[{sample.point.tet, fibre.muscle}];
    sum.volume += sample.volume;
    sum.direction += sample.volume * fibre.direction;
  }
  std::vector<FibreTet> fibres;
  for (const auto& [key, sum] : sums) {
    const double norm = sum.direction.norm(), share = sum.volume / (tet_edges(cage.mesh, key.first).determinant() / 6);
    if (!(norm > 0)) continue;
    const FibreTet fibre{key.first, key.second, sum.direction / norm, std::min(share, 1.0)};
    if (fibres.empty() || fibres.back().tet != fibre.tet) {
      fibres.push_back(fibre);
    } else if (fibres.back().share < fibre.share) {
      fibres.back() = fibre;
    }
  }
  add_thin_muscles(paths, cage.mesh, places, fibres);
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

bool matches_pattern(const std::string& pattern, const std::string& name) {
  if (!pattern.ends_with('*')) return name == pattern;
  return name.starts_with(std::string_view(pattern).substr(0, pattern.size() - 1));
}

std::vector<std::vector<std::size_t>> flexed_muscles(const std::vector<std::string>& controls,
                                                     const std::vector<Muscle>& muscles) {
  std::vector<std::vector<std::size_t>> flexed;
  for (const std::string& control : controls) {
    std::vector<std::size_t>& found = flexed.emplace_back();
    for (std::size_t m = 0; m < muscles.size(); ++m) {
      if (matches_pattern(control, muscles[m].name)) found.push_back(m);
    }
    if (found.empty()) {
      throw Error(ErrorKind::mismatch, "the control '" + control + "' flexes none of the " +
                                           std::to_string(muscles.size()) +
                                           " muscles: expected a muscle's name, or the beginning of some and '*'");
    }
  }
  return flexed;
}

}  // namespace bodyopt
