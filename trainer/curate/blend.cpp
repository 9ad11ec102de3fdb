// blend: towards the shapes that another cache has of some frames of a take.
#include <map>

#include "assets/frame_range.h"
#include "assets/json_file.h"
#include "runtime/core/error.h"
#include "trainer/curate/hash_of.h"
#include "trainer/curate/modifier_type.h"

namespace bodyopt {

ShapeModifier prepare_blend(const ModifierInput& input) {
  const std::filesystem::path path = input.database.dataset.folder / input.parameters.name("cache");
  const auto reader = std::make_shared<const ShapeReader>(path);
  const std::vector<int> frames = parse_frame_range(input.parameters.name("frames"));
  if (reader->sample_count() != frames.size() || reader->point_count() != input.database.character.output_count()) {
    throw Error(ErrorKind::mismatch,
                input.place + ": " + path.string() + " has " + std::to_string(reader->sample_count()) + " samples of " +
                    std::to_string(reader->point_count()) + " points, expected " + std::to_string(frames.size()) +
                    " (its 'frames') of " + std::to_string(input.database.character.output_count()) +
                    " (the character's vertices): made from another mesh, or of other frames");
  }
  std::map<std::size_t, std::uint32_t> samples;  // of the cache, by frame of the database
  const std::string take = input.parameters.name("take");
  for (std::size_t n = 0; n < input.database.frames.size(); ++n) {
    if (input.database.take_of(n) != take) continue;
    for (std::uint32_t k = 0; k < frames.size(); ++k) {
      if (frames[k] == input.database.frames[n].frame) samples[n] = k;
    }
  }
  if (samples.empty()) {
    throw Error(ErrorKind::mismatch, input.place + ": the dataset has no solved frame " +
                                         input.parameters.name("frames") + " of a take '" + take + "'");
  }
  const auto shape_of = [reader, samples, &character = input.database.character](std::size_t frame) {
    const auto sample = samples.find(frame);
    if (sample == samples.end()) return std::optional<Positions>();
    return std::optional(welded_from_output(character, reader->sample(sample->second).data()));
  };
  return {.cause = [=](std::size_t frame) -> std::optional<std::uint64_t> {
            const std::optional<Positions> shape = shape_of(frame);
            if (!shape) return std::nullopt;
            return hash_of(*shape);
          },
          .apply =
              [=](const FrameInHand& frame, Positions& offsets) {
                if (const auto shape = shape_of(frame.number)) offsets = frame.space.offsets(*shape);
              }};
}

}  // namespace bodyopt
