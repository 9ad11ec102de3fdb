// detail: what smoothing takes from one frame, in the place of what it takes from others.
#include "assets/json_file.h"
#include "geometry/laplacian.h"
#include "trainer/curate/hash_of.h"
#include "trainer/curate/modifier_type.h"

namespace bodyopt {
namespace {

class BorrowedDetail : public ShapeModifier {
 public:
  BorrowedDetail(const Character& character, double radius, const Positions& source)
      : radius_(radius),
        smoother_(character.vertices, character.triangles, radius),
        fine_(source - Positions(smoother_(source))) {}
  std::optional<std::uint64_t> cause(std::size_t) const override {
    ContentHash hash;
    hash.add(radius_);
    hash.add(hash_of(fine_));
    return hash.value();
  }
  void apply(const FrameInHand&, Positions& offsets) const override { offsets = smoother_(offsets) + fine_; }

 private:
  double radius_;  // metres
  SkinSmoother smoother_;
  Positions fine_;  // V x 3
};

}  // namespace

std::unique_ptr<ShapeModifier> prepare_detail(const ModifierInput& input) {
  const std::size_t source =
      input.database.find(input.parameters.name("take"), input.parameters.integer("frame"), input.place);
  const double radius = 1e-3 * parameter(input, "radius_mm", 20, 0.01, 1000);
  return std::make_unique<BorrowedDetail>(input.database.character, radius, input.below(source));
}

}  // namespace bodyopt
