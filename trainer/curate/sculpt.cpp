// sculpt: what an artist made of single frames, as un-posed offsets, spread to poses nearby (sculpted_frames.h).
#include "trainer/curate/hash_of.h"
#include "trainer/curate/modifier_type.h"
#include "trainer/curate/sculpted_frames.h"

namespace bodyopt {

ShapeModifier prepare_sculpt(const ModifierInput& input) {
  const auto sculpted = std::make_shared<const SculptedFrames>(input.database, input.parameters, input.place);
  return {.cause = [=](std::size_t frame) -> std::optional<std::uint64_t> {
            const Positions sum = sculpted->sum(frame);
            if (sum.isZero(0)) return std::nullopt;
            return hash_of(sum);
          },
          .apply = [=](const FrameInHand& frame, Positions& offsets) { offsets += sculpted->sum(frame.number); }};
}

}  // namespace bodyopt
