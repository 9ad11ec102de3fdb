// Flex: a muscle that tenses without moving its joints bulges at its belly and draws in towards its ends. Of one muscle
// of muscles.json, or of all.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "assets/characters/muscles.h"
#include "base/json_file.h"
#include "base/wording.h"
#include "geometry/mesh.h"
#include "geometry/surface_distance.h"
#include "runtime/core/error.h"
#include "trainer/modifiers/bake_modifier.h"

namespace bodyopt::trainer {
namespace {

Eigen::Vector3d point_of(const MusclePoint& point) { return {point.position[0], point.position[1], point.position[2]}; }

struct MusclePlace {
  double distance = 1e9;  // metres, to the nearest point of the path
  double along = 0;       // of that point, 0 at the origin, 1 at the insertion
};

MusclePlace place_on(const Muscle& muscle, const Eigen::Vector3d& p) {
  MusclePlace nearest;
  double before = 0;
  for (std::size_t k = 0; k + 1 < muscle.path.size(); ++k) {
    const Eigen::Vector3d a = point_of(muscle.path[k]), edge = point_of(muscle.path[k + 1]) - a;
    const double length = edge.norm(), t = length > 0 ? std::clamp((p - a).dot(edge) / (length * length), 0.0, 1.0) : 0;
    const double distance = (p - a - t * edge).norm();
    if (distance < nearest.distance) nearest = {distance, before + t * length};
    before += length;
  }
  nearest.along /= std::max(before, 1e-9);
  return nearest;
}

// How far the skin goes out, in parts of the bulge: 1 over the belly, below 0 near the ends, 0 away from the muscle.
double bulge_at(const Muscle& muscle, const MusclePlace& place) {
  const double reach = place.distance / (2.5 * muscle.radius);
  if (reach >= 1 || place.along <= 0 || place.along >= 1) return 0;
  const double belly = std::sin(std::numbers::pi * place.along), near = 1 - reach * reach;
  return near * near * belly * (2 * belly * belly - 1);
}

}  // namespace

BakedModifier bake_flex(const BakeInput& input) {
  const std::filesystem::path path = input.folder / input.parameters.name("muscles");
  const std::vector<Muscle> muscles = read_muscles(path, input.basis.skeleton);
  const std::string wanted = input.parameters.has("muscle") ? input.parameters.name("muscle") : "";
  const std::vector<std::string> names = names_of(muscles);
  if (!wanted.empty() && std::ranges::find(names, wanted) == names.end()) {
    input.parameters.refuse("flexes the muscle '", wanted, "'; ", path, " has ", list_names(names));
  }
  const Positions rest = rows_of(input.basis.mesh.rest);
  const Triangles triangles = rows_of(input.basis.mesh.triangles);
  const Positions normals = vertex_normals(rest, triangles).rowwise().normalized();
  Eigen::VectorXd out = Eigen::VectorXd::Zero(rest.rows());
  double radius = 0;
  for (const Muscle& muscle : muscles) {
    if (!wanted.empty() && muscle.name != wanted) continue;
    radius = std::max(radius, muscle.radius);
    for (Eigen::Index v = 0; v < rest.rows(); ++v) {
      const double own = bulge_at(muscle, place_on(muscle, rest.row(v).transpose()));
      if (std::abs(own) > std::abs(out[v])) out[v] = own;
    }
  }
  const Eigen::MatrixXd even = smoothed(rest, triangles, out, 0.3 * radius);
  const double most = even.col(0).maxCoeff();
  if (!(most > 1e-3)) {
    throw Error(ErrorKind::mismatch, input.place,
                ": no skin lies over the muscle within two and a half of its radius: "
                "is it of this character, and its radius in metres?");
  }
  const double bulge = 1e-3 * bake_number(input, "bulge_mm", 6, 0, 100);
  BakedModifier baked;
  baked.components.push_back(Positions((bulge / most * even.col(0)).asDiagonal() * normals));
  return baked;
}

}  // namespace bodyopt::trainer
