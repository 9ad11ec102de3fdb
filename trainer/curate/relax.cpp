// relax: evens out how vertices have slid along the skin, and leaves how far they stand off it.
#include "geometry/laplacian.h"
#include "geometry/vertex_normals.h"
#include "trainer/curate/hash_of.h"
#include "trainer/curate/modifier_type.h"

namespace bodyopt {

ShapeModifier prepare_relax(const ModifierInput& input) {
  const Character& character = input.database.character;
  const double radius = 1e-3 * parameter(input, "radius_mm", 10, 0.01, 1000);  // metres
  const auto smoother = std::make_shared<const SkinSmoother>(character.vertices, character.triangles, radius);
  // V x 3, at rest, unit or zero.
  const Positions normals = vertex_normals(character.vertices, character.triangles).rowwise().normalized();
  return {.cause = [=](std::size_t) { return hash_of(radius); },
          .apply =
              [=](const FrameInHand&, Positions& offsets) {
                const Positions change = (*smoother)(offsets)-offsets;
                const Eigen::VectorXd off_skin = change.cwiseProduct(normals).rowwise().sum();
                offsets += change - Positions(off_skin.asDiagonal() * normals);
              }};
}

}  // namespace bodyopt
