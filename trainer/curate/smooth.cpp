// smooth: the displacement, evened out over the skin by a Gaussian. What the rest skin has of detail stays.
#include "geometry/laplacian.h"
#include "trainer/curate/hash_of.h"
#include "trainer/curate/modifier_type.h"

namespace bodyopt {
namespace {

class Smooth : public ShapeModifier {
 public:
  Smooth(const Character& character, double radius)
      : radius_(radius), smoother_(character.vertices, character.triangles, radius) {}
  std::optional<std::uint64_t> cause(std::size_t) const override { return hash_of(radius_); }
  void apply(const FrameInHand&, Positions& offsets) const override { offsets = smoother_(offsets); }

 private:
  double radius_;  // metres
  SkinSmoother smoother_;
};

}  // namespace

std::unique_ptr<ShapeModifier> prepare_smooth(const ModifierInput& input) {
  return std::make_unique<Smooth>(input.database.character, 1e-3 * parameter(input, "radius_mm", 10, 0.01, 1000));
}

}  // namespace bodyopt
