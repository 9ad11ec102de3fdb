// smooth: the displacement, evened out over the skin by a Gaussian. What the rest skin has of detail stays.
#include "geometry/laplacian.h"
#include "trainer/curate/hash_of.h"
#include "trainer/curate/modifier_type.h"

namespace bodyopt {

ShapeModifier prepare_smooth(const ModifierInput& input) {
  const Character& character = input.database.character;
  const double radius = 1e-3 * parameter(input, "radius_mm", 10, 0.01, 1000);  // metres
  const auto smoother = std::make_shared<const SkinSmoother>(character.vertices, character.triangles, radius);
  return {.cause = [=](std::size_t) { return hash_of(radius); },
          .apply = [=](const FrameInHand&, Positions& offsets) { offsets = (*smoother)(offsets); }};
}

}  // namespace bodyopt
