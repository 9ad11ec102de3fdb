#include "trainer/train/strain.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <map>

#include "runtime/cpu/kernels.h"
#include "runtime/rig.h"
#include "trainer/train/closest_point.h"

namespace bodyopt {
namespace {

constexpr double kSpacing = 0.012;    // metres between the points of a path
constexpr double kSpread = 0.7;       // outermost fibres, in muscle radii
constexpr double kShortest = 0.005;   // metres; a shorter fibre measures noise
constexpr double kSamePoint = 0.002;  // metres between neighbours on the skin

using Polyline = std::vector<Eigen::Vector3d>;

Polyline resample(const std::vector<MusclePoint>& path) {
  Polyline points;
  for (std::size_t k = 0; k + 1 < path.size(); ++k) {
    const Eigen::Vector3d a(path[k].position.data()), b(path[k + 1].position.data());
    const int steps = std::clamp(static_cast<int>((b - a).norm() / kSpacing), 1, 1000);
    for (int s = 0; s < steps; ++s) points.push_back(a + (b - a) * s / steps);
  }
  if (!path.empty()) points.emplace_back(path.back().position.data());
  return points;
}

// From each point to the skin, averaged along the path so that neighbours agree on the side. Unit vectors.
Polyline skin_directions(const Polyline& path, const ClosestPoint& skin) {
  Polyline nearest;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& point : path) {
    nearest.push_back((skin.find(point).position - point).normalized());
    mean += nearest.back() / static_cast<double>(path.size());
  }
  Polyline directions;
  for (std::size_t k = 0; k < path.size(); ++k) {
    Eigen::Vector3d sum = mean;
    for (std::size_t n = k < 2 ? 0 : k - 2; n < std::min(path.size(), k + 3); ++n) sum += nearest[n];
    directions.push_back(sum.normalized());
  }
  return directions;
}

// The path shifted by `offset` metres to the side and pushed to the surface, projected to the skin.
std::vector<SurfacePoint> project(const Polyline& path, const Polyline& directions, const Muscle& muscle, double offset,
                                  const ClosestPoint& skin) {
  std::vector<SurfacePoint> fibre;
  for (std::size_t k = 0; k < path.size(); ++k) {
    const Eigen::Vector3d tangent = path[std::min(k + 1, path.size() - 1)] - path[k == 0 ? 0 : k - 1];
    const Eigen::Vector3d side = tangent.cross(directions[k]).normalized();
    const SurfacePoint point = skin.find(path[k] + offset * side + muscle.radius * directions[k]);
    if (fibre.empty() || (point.position - fibre.back().position).norm() > kSamePoint) fibre.push_back(point);
  }
  return fibre;
}

double polyline_length(const std::vector<SurfacePoint>& fibre) {
  double sum = 0;
  for (std::size_t k = 1; k < fibre.size(); ++k) sum += (fibre[k].position - fibre[k - 1].position).norm();
  return sum;
}

class TableBuilder {
 public:
  explicit TableBuilder(const MeshTable& mesh) : mesh_(mesh) { table_.fibre_begin = {0}; }

  void add(const std::vector<SurfacePoint>& fibre, const std::string& name) {
    for (const SurfacePoint& point : fibre) {
      const std::uint32_t* corners = mesh_.triangles.data() + 3 * std::size_t{point.triangle};
      const Eigen::Vector3f w = point.weights.cast<float>();
      table_.points.push_back({index(corners[0]), index(corners[1]), index(corners[2]), w[0], w[1], w[2]});
    }
    table_.fibre_begin.push_back(static_cast<std::uint32_t>(table_.points.size()));
    table_.rest_length.push_back(1);
    table_.names.push_back(name);
  }
  StrainTable take() { return std::move(table_); }

 private:
  std::uint32_t index(std::uint32_t vertex) {
    const auto [entry, is_new] = indices_.emplace(vertex, static_cast<std::uint32_t>(table_.vertices.size()));
    if (is_new) table_.vertices.push_back(vertex);
    return entry->second;
  }
  const MeshTable& mesh_;
  StrainTable table_;
  std::map<std::uint32_t, std::uint32_t> indices_;
};

// By the kernels of the run time: with rest lengths of 1 m the strain is the length minus one.
void measure_rest_lengths(StrainTable& table, const DdmTable& ddm, const Skeleton& skeleton) {
  const RigFrame rest = pose_rig(skeleton, bind_pose(skeleton));
  std::vector<float> positions(3 * table.vertices.size()), strains(table.fibre_count());
  cpu::strain_skin(ddm, table, static_cast<std::uint32_t>(skeleton.size()), rest.skinning, positions);
  cpu::strain_measure(table, positions, strains);
  for (std::size_t k = 0; k < strains.size(); ++k) table.rest_length[k] = strains[k] + 1;
}

}  // namespace

StrainTable make_strain_table(const MeshTable& mesh, const DdmTable& ddm, const Skeleton& skeleton,
                              const std::vector<Muscle>& muscles, std::vector<std::string>& notes) {
  TableBuilder builder(mesh);
  if (!mesh.triangles.empty()) {
    const ClosestPoint skin(mesh);
    for (const Muscle& muscle : muscles) {
      const Polyline path = resample(muscle.path);
      const Polyline directions = skin_directions(path, skin);
      for (int n = 0; n < muscle.fibre_count; ++n) {
        const double place = muscle.fibre_count == 1 ? 0 : 2.0 * n / (muscle.fibre_count - 1) - 1;
        const auto fibre = project(path, directions, muscle, kSpread * muscle.radius * place, skin);
        const std::string name = muscle.name + "/" + std::to_string(n + 1);
        if (polyline_length(fibre) < kShortest) {
          notes.push_back("fibre '" + name + "' is left out: on the skin it shrinks to a point");
        } else {
          builder.add(fibre, name);
        }
      }
    }
  }
  StrainTable table = builder.take();
  measure_rest_lengths(table, ddm, skeleton);
  return table;
}

}  // namespace bodyopt
