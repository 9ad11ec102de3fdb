// sculpt: what an artist made of single frames, as un-posed offsets, spread to poses nearby (sculpted_frames.h).
#include "trainer/curate/modifier_type.h"
#include "trainer/curate/sculpted_frames.h"

namespace bodyopt {
namespace {

class Sculpt : public ShapeModifier {
 public:
  explicit Sculpt(SculptedFrames sculpted) : sculpted_(std::move(sculpted)) {}

  void apply(const FrameInHand& frame, Positions& offsets) const override { offsets += sculpted_.sum(frame.number); }

 private:
  SculptedFrames sculpted_;
};

}  // namespace

std::unique_ptr<ShapeModifier> prepare_sculpt(const ModifierInput& input) {
  return std::make_unique<Sculpt>(SculptedFrames(input.database, input.parameters, input.place));
}

}  // namespace bodyopt
