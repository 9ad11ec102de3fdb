// detail: what smoothing takes from one frame, in the place of what it takes from others.
#include "geometry/laplacian.h"
#include "trainer/curate/modifier_type.h"

namespace bodyopt {
namespace {

class Detail : public ShapeModifier {
 public:
  Detail(const Character& character, double radius, const Positions& source)
      : smoother_(character.vertices, character.triangles, radius), fine_(source - Positions(smoother_(source))) {}
  void apply(const FrameInHand&, Positions& offsets) const override { offsets = smoother_(offsets) + fine_; }

 private:
  SkinSmoother smoother_;
  Positions fine_;  // V x 3
};

}  // namespace

std::unique_ptr<ShapeModifier> prepare_detail(const ModifierInput& input) {
  const std::size_t source =
      input.database.find(input.parameters.name("take"), input.parameters.integer("frame"), input.place);
  const double radius = 1e-3 * parameter(input, "radius_mm", 20, 0.01, 1000);
  return std::make_unique<Detail>(input.database.character, radius, input.below(source));
}

}  // namespace bodyopt
