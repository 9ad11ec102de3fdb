// smooth: the displacement, evened out over the skin by a Gaussian. What the rest skin has of detail stays.
#include "assets/json_file.h"
#include "geometry/mesh.h"
#include "geometry/surface_distance.h"
#include "trainer/curate/modifier_types.h"
#include "trainer/curate/offset_cache.h"

namespace bodyopt {

ShapeModifier prepare_smooth(const ModifierInput& input) {
  const Character& character = input.database.character;
  const double radius = 1e-3 * parameter(input, "radius_mm", 10, 0.01, 1000);  // metres
  const auto smoother = std::make_shared<const SkinSmoother>(character.vertices, character.triangles, radius);
  return {.cause = [=](std::size_t) { return hash_of(radius); },
          .apply = [=](const FrameInHand&, Positions& offsets) { offsets = (*smoother)(offsets); }};
}

// relax: evens out how vertices have slid along the skin, and leaves how far they stand off it.

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

// detail: what smoothing takes from one frame, in the place of what it takes from others.

ShapeModifier prepare_detail(const ModifierInput& input) {
  const Character& character = input.database.character;
  const std::size_t source =
      input.database.find(input.parameters.name("take"), input.parameters.integer("frame"), input.place);
  const double radius = 1e-3 * parameter(input, "radius_mm", 20, 0.01, 1000);  // metres
  const Positions whole = input.below(source);
  const auto smoother = std::make_shared<const SkinSmoother>(character.vertices, character.triangles, radius);
  const Positions fine = whole - Positions((*smoother)(whole));
  ContentHash hash;
  hash.add(radius);
  hash.add(hash_of(fine));
  return {.cause = [value = hash.value()](std::size_t) { return value; },
          .apply = [=](const FrameInHand&, Positions& offsets) { offsets = (*smoother)(offsets) + fine; }};
}

}  // namespace bodyopt
