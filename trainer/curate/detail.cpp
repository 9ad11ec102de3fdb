// detail: what smoothing takes from one frame, in the place of what it takes from others.
#include "assets/json_file.h"
#include "geometry/laplacian.h"
#include "trainer/curate/hash_of.h"
#include "trainer/curate/modifier_type.h"

namespace bodyopt {

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
