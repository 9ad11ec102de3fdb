// inflate: the skin along its normals, outwards or (below 0) inwards.
#include <algorithm>

#include "geometry/mend_surface.h"
#include "geometry/mesh.h"
#include "trainer/curate/modifier_types.h"
#include "trainer/curate/offset_cache.h"

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

// volume: what the closed skin lost of its volume at rest is given back where the mask says, along the normals, by the
// same distance everywhere (times the mask).

ShapeModifier prepare_volume(const ModifierInput& input) {
  const Character& character = input.database.character;
  const double cap = 1e-3 * parameter(input, "cap_mm", 10, 0, 1000);             // metres
  const double rest = enclosed_volume(character.vertices, character.triangles);  // cubic metres
  return {.cause = [=](std::size_t) { return hash_of(cap); },
          .apply =
              [cap, rest, mask = input.mask, &triangles = character.triangles](const FrameInHand& frame,
                                                                               Positions& offsets) {
                Positions skin = frame.space.shape(offsets);
                // A sixth of the sum of the normals of a vertex's triangles, each twice its area long: what the volume
                // grows by.
                const Positions growth = vertex_normals(skin, triangles) / 6;
                const Positions direction = growth.rowwise().normalized();
                const double per_metre = growth.cwiseProduct(direction).rowwise().sum().dot(mask);
                const double lost = rest - enclosed_volume(skin, triangles);
                if (!(per_metre > 0) || !(lost > 0)) return;
                skin += std::min(lost / per_metre, cap) * direction;
                offsets = frame.space.offsets(skin);
              }};
}

}  // namespace bodyopt
