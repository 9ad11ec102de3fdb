// inflate: the skin along its normals, outwards or (below 0) inwards.
#include "geometry/vertex_normals.h"
#include "trainer/curate/hash_of.h"
#include "trainer/curate/modifier_type.h"

namespace bodyopt {
namespace {

class Inflate : public ShapeModifier {
 public:
  Inflate(const Triangles& triangles, double distance) : triangles_(triangles), distance_(distance) {}
  std::optional<std::uint64_t> cause(std::size_t) const override { return hash_of(distance_); }
  void apply(const FrameInHand& frame, Positions& offsets) const override {
    Positions skin = frame.space.shape(offsets);
    skin += distance_ * Positions(vertex_normals(skin, triangles_).rowwise().normalized());
    offsets = frame.space.offsets(skin);
  }

 private:
  const Triangles& triangles_;
  double distance_;  // metres
};

}  // namespace

std::unique_ptr<ShapeModifier> prepare_inflate(const ModifierInput& input) {
  return std::make_unique<Inflate>(input.database.character.triangles,
                                   1e-3 * parameter(input, "distance_mm", 1, -1000, 1000));
}

}  // namespace bodyopt
