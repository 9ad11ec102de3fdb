// sculpt: what an artist made of single frames, as un-posed offsets, spread to poses nearby (sculpted_frames.h).
#include "trainer/curate/hash_of.h"
#include "trainer/curate/modifier_type.h"
#include "trainer/curate/sculpted_frames.h"

namespace bodyopt {
namespace {

class Sculpt : public ShapeModifier {
 public:
  explicit Sculpt(SculptedFrames sculpted) : sculpted_(std::move(sculpted)) {}

  std::optional<std::uint64_t> cause(std::size_t frame) const override {
    const Positions sum = sculpted_.sum(frame);
    if (sum.isZero(0)) return std::nullopt;
    return hash_of(sum);
  }

  void apply(const FrameInHand& frame, Positions& offsets) const override { offsets += sculpted_.sum(frame.number); }

 private:
  SculptedFrames sculpted_;
};

}  // namespace

std::unique_ptr<ShapeModifier> prepare_sculpt(const ModifierInput& input) {
  return std::make_unique<Sculpt>(SculptedFrames(input.database, input.parameters, input.place));
}

}  // namespace bodyopt
