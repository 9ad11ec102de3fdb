// inflate: the skin along its normals, outwards or (below 0) inwards.
#include "geometry/vertex_normals.h"
#include "trainer/curate/hash_of.h"
#include "trainer/curate/modifier_type.h"

namespace bodyopt {

ShapeModifier prepare_inflate(const ModifierInput& input) {
  const double distance = 1e-3 * parameter(input, "distance_mm", 1, -1000, 1000);  // metres
  return {
      .cause = [=](std::size_t) { return hash_of(distance); },
      .apply =
          [distance, &triangles = input.database.character.triangles](const FrameInHand& frame, Positions& offsets) {
            Positions skin = frame.space.shape(offsets);
            skin += distance * Positions(vertex_normals(skin, triangles).rowwise().normalized());
            offsets = frame.space.offsets(skin);
          }};
}

}  // namespace bodyopt
