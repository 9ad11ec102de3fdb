// The frames of a dataset that are trained on, and those held out.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "assets/characters/character.h"
#include "assets/characters/muscles.h"
#include "geometry/mesh.h"
#include "geometry/region_weights.h"

namespace bodyopt {
class ShapeReader;
struct Dataset;
}  // namespace bodyopt

namespace bodyopt::trainer {

class ShapeStack;

// A cache and the character whose skin it shows. Shapes may be read on several threads.
struct ShapeCache {
  std::shared_ptr<const ShapeReader> reader;
  std::shared_ptr<const Character> character;
};

// Welded vertices, of a skin whose others are left out.
using VertexRows = std::vector<std::uint32_t>;

// The shape of one frame, of the whole skin or of some of its vertices, fetched when it is needed. It is in memory, a
// sample of a cache, or a frame of a dataset through its modifiers.
class SampleShape {
 public:
  SampleShape() = default;
  SampleShape(Positions positions) : positions_(std::make_shared<const Positions>(std::move(positions))) {}
  SampleShape(std::shared_ptr<const ShapeCache> cache, std::uint32_t sample)
      : cache_(std::move(cache)), sample_(sample) {}
  SampleShape(std::shared_ptr<const ShapeStack> stack, std::size_t frame) : stack_(std::move(stack)), frame_(frame) {}

  // Returns this shape at some of the vertices, in that order.
  SampleShape at(std::shared_ptr<const VertexRows> rows) const;

  // Welded, V x 3, posed, metres. Throws Error(file) at a damaged sample.
  Positions read() const;

 private:
  Positions whole() const;

  std::shared_ptr<const Positions> positions_;
  std::shared_ptr<const ShapeCache> cache_;
  std::shared_ptr<const ShapeStack> stack_;
  std::shared_ptr<const VertexRows> rows_;  // none: the whole skin
  std::uint32_t sample_ = 0;
  std::size_t frame_ = 0;
};

// Up to so many training frames, more is tried, with more care, and bytes do not matter: see choose_map.
constexpr std::size_t kFewFrames = 800;

// One training or held-out frame.
struct Sample {
  int take = 0;
  int frame = 0;
  Pose pose;
  SampleShape shape;
  double weight = 1;      // how many times it counts
  std::size_t place = 0;  // among all frames of its take, those that are left out, too; a mirror image has its origin's
  int image_of = -1;      // the take of the frame whose mirror image this is
};

// The dataset, split; shapes stay on disk. Unconverged frames are left out and counted.
struct SampleSet {
  Character character;
  std::vector<Muscle> muscles;
  std::vector<std::string> takes;      // names, by Sample::take
  std::vector<std::string> controls;   // of every pose, by name
  std::vector<RegionWeights> regions;  // painted: as read_regions
  std::vector<Sample> train, heldout;
  int unconverged = 0;
  bool sparse = false;  // neighbours lie far apart and move apart, as on a proxy: none of them is held to be an outlier
  std::vector<std::string> notes;

  // The name of the take that a frame is of.
  const std::string& take_of(const Sample& sample) const { return takes[static_cast<std::size_t>(sample.take)]; }
};
SampleSet read_samples(const Dataset& dataset);

// For every training frame itself, or the training frame whose mirror image it is. What a frame tells its image tells,
// too: cross-validation has both in one fold.
std::vector<std::size_t> training_origins(const SampleSet& set);

std::vector<const Pose*> poses_of(const std::vector<Sample>& samples);

// Poses of the training frames.
std::vector<Pose> training_poses(const SampleSet& set);

// "frame 12 of take 'rom'".
std::string frame_name(const SampleSet& set, const Sample& sample);

constexpr std::size_t kFewestFrames = 12;  // to train on: fewer cannot be split for cross-validation

// Throws Error(mismatch) where there are too few training frames, or one has a number that is not finite.
void check_samples(const SampleSet& set);

}  // namespace bodyopt::trainer
