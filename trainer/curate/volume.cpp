// volume: what the closed skin lost of its volume at rest is given back where the mask says, along the normals, by the
// same distance everywhere (times the mask).
#include <algorithm>

#include "geometry/closed_skin.h"
#include "geometry/vertex_normals.h"
#include "trainer/curate/hash_of.h"
#include "trainer/curate/modifier_type.h"

namespace bodyopt {
namespace {

class Volume : public ShapeModifier {
 public:
  Volume(const ModifierInput& input, double cap)
      : character_(input.database.character),
        mask_(input.mask),
        cap_(cap),
        rest_(enclosed_volume(character_.vertices, character_.triangles)) {}

  std::optional<std::uint64_t> cause(std::size_t) const override { return hash_of(cap_); }

  void apply(const FrameInHand& frame, Positions& offsets) const override {
    Positions skin = frame.space.shape(offsets);
    // A sixth of the sum of the normals of a vertex's triangles, each twice its area long: what the volume grows by.
    const Positions growth = vertex_normals(skin, character_.triangles) / 6;
    const Positions direction = growth.rowwise().normalized();
    const double per_metre = growth.cwiseProduct(direction).rowwise().sum().dot(mask_);
    const double lost = rest_ - enclosed_volume(skin, character_.triangles);
    if (!(per_metre > 0) || !(lost > 0)) return;
    skin += std::min(lost / per_metre, cap_) * direction;
    offsets = frame.space.offsets(skin);
  }

 private:
  const Character& character_;
  Eigen::VectorXd mask_;
  double cap_, rest_;  // metres, cubic metres
};

}  // namespace

std::unique_ptr<ShapeModifier> prepare_volume(const ModifierInput& input) {
  return std::make_unique<Volume>(input, 1e-3 * parameter(input, "cap_mm", 10, 0, 1000));
}

}  // namespace bodyopt
