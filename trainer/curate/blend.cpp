// blend: towards the shapes that another cache has of some frames of a take.
#include <map>

#include "assets/frame_range.h"
#include "assets/json_file.h"
#include "runtime/core/error.h"
#include "trainer/curate/hash_of.h"
#include "trainer/curate/modifier_type.h"

namespace bodyopt {
namespace {

class Blend : public ShapeModifier {
 public:
  Blend(const Character& character, ShapeReader reader, std::map<std::size_t, std::uint32_t> samples)
      : character_(character), reader_(std::move(reader)), samples_(std::move(samples)) {}

  std::optional<std::uint64_t> cause(std::size_t frame) const override {
    const auto sample = samples_.find(frame);
    if (sample == samples_.end()) return std::nullopt;
    return hash_of(welded_from_output(character_, reader_.sample(sample->second).data()));
  }

  void apply(const FrameInHand& frame, Positions& offsets) const override {
    const auto sample = samples_.find(frame.number);
    if (sample == samples_.end()) return;
    offsets = frame.space.offsets(welded_from_output(character_, reader_.sample(sample->second).data()));
  }

 private:
  const Character& character_;
  ShapeReader reader_;
  std::map<std::size_t, std::uint32_t> samples_;  // of the cache, by frame of the database
};

}  // namespace

std::unique_ptr<ShapeModifier> prepare_blend(const ModifierInput& input) {
  const std::filesystem::path path = input.database.dataset.folder / input.parameters.name("cache");
  ShapeReader reader(path);
  const std::vector<int> frames = parse_frame_range(input.parameters.name("frames"));
  if (reader.sample_count() != frames.size() || reader.point_count() != input.database.character.output_count()) {
    throw Error(ErrorKind::mismatch,
                input.place + ": " + path.string() + " has " + std::to_string(reader.sample_count()) + " samples of " +
                    std::to_string(reader.point_count()) + " points, expected " + std::to_string(frames.size()) +
                    " (its 'frames') of " + std::to_string(input.database.character.output_count()) +
                    " (the character's vertices): made from another mesh, or of other frames");
  }
  std::map<std::size_t, std::uint32_t> samples;
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
  return std::make_unique<Blend>(input.database.character, std::move(reader), std::move(samples));
}

}  // namespace bodyopt
