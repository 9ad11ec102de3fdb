// The results of a training in a folder beside the basis, stage by stage: the layout of the regions, then every region
// once fitted. With it, training goes on after an interruption, makes a basis of another size at once, and learns a few
// new frames quickly. Every file says what it was found from; one that belongs to something else is as good as none.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "trainer/train/data/samples.h"
#include "trainer/train/fit/groundwork.h"
#include "trainer/train/options.h"
#include "trainer/train/pack/residual.h"

namespace bodyopt::trainer {

// Keys of the data that a training learns from.
struct TrainingKeys {
  std::uint64_t subject = 0;          // character, muscles, painted regions, and the options that shape what is fitted
  std::vector<std::uint64_t> frames;  // of every training frame: pose and shape
  std::uint64_t takes = 0;            // where a take ends and the next begins
  std::vector<std::uint64_t> heldout;
};

// Reads every shape. Shows progress. Throws Error(file) where a shape cannot be read.
TrainingKeys training_keys(const SampleSet& set, const TrainOptions& options);

struct KeptLayout {
  std::uint64_t key = 0;  // of the training whose regions belong to it
  TrainingKeys from;
  double smoothing_radius = 0;  // metres
  std::vector<Muscle> curves;   // on the surface
  RawFeatures features;         // of every frame
  Layout layout;
};

std::uint64_t muscles_hash(const std::vector<Muscle>& muscles);

// The key of a training from the start, and of one that brings an earlier training to other frames.
std::uint64_t training_key(const TrainingKeys& keys, double smoothing_radius);
std::uint64_t updated_key(std::uint64_t earlier, const TrainingKeys& keys);

class TrainingStore {
 public:
  // `folder` is made with the first file. None: nothing is kept, nothing found.
  // Throws Error(file) where `folder` is something else.
  explicit TrainingStore(std::filesystem::path folder);

  bool keeps() const { return !folder_.empty(); }
  // None where there is no file, or it is of another version. Throws Error(file) where it is damaged.
  std::optional<KeptLayout> layout() const;
  std::optional<RegionModel> region(std::size_t number, std::uint64_t key) const;
  // Throw Error(file). A layout is kept in place of any other; regions of other keys stay until they are forgotten.
  void keep(const KeptLayout& layout) const;
  void keep(std::size_t number, std::uint64_t key, const RegionModel& model) const;
  void forget_other_regions(std::uint64_t key) const;

 private:
  std::filesystem::path layout_path() const;
  std::filesystem::path region_path(std::size_t number, std::uint64_t key) const;
  std::filesystem::path folder_;
};

}  // namespace bodyopt::trainer
