// The whole fit, stage by stage: what an earlier training kept is used, what is missing is fitted.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "runtime/core/atomic_file.h"
#include "trainer/train/data/samples.h"
#include "trainer/train/fit/fit_regions.h"
#include "trainer/train/fit/training_store.h"
#include "trainer/train/options.h"
#include "trainer/train/pack/residual.h"

namespace bodyopt::trainer {

class StagedFit {
 public:
  // `notes`: what the user should know of what was used. All must outlive this. Throws Error(file) where another run
  // keeps what it finds in the same folder.
  StagedFit(const SampleSet& set, const TrainOptions& options, std::vector<std::string>& notes);

  // The groundwork's inputs beside the samples: curves on their surface, options, features that the earlier training
  // measured. The options have its smoothing radius where it is brought to these frames.
  const std::vector<Muscle>& curves() const { return curves_; }
  TrainOptions options() const;
  EarlierFeatures earlier_features() const;

  // Whether the earlier training can be brought to frames that move so; if not, another StagedFit without
  // options.update has to do it.
  bool suits(const Groundwork& ground) const;

  // Layout and regions; shows progress. As train(): the same with and without an interruption.
  Layout layout(const Groundwork& ground);
  std::vector<RegionModel> regions(const Groundwork& ground, const Layout& layout);
  // After layout(): whether the fit is that of an earlier training brought to these frames.
  bool is_update(const Groundwork& ground) const { return key_ != training_key(keys_, ground.base.radius); }

 private:
  void look_back();  // at what an earlier training kept
  bool can_update() const;
  void keep(const Groundwork& ground, const Layout& layout) const;
  std::vector<std::size_t> update(const FitContext& context, std::vector<RegionModel>& models,
                                  const std::vector<std::size_t>& missing, const RegionDone& done,
                                  const std::string& kept);

  const SampleSet& set_;
  const TrainOptions& options_;
  std::vector<std::string>& notes_;
  TrainingStore store_;
  std::optional<RunLock> lock_;  // on the store
  TrainingKeys keys_;
  std::optional<KeptLayout> earlier_;
  bool is_of_others_ = false;        // what is kept is of another character or other options: none of it is used
  std::vector<int> earlier_frames_;  // of every frame its number in the earlier training, -1: new
  std::vector<Muscle> curves_;
  bool updates_ = false;
  std::uint64_t key_ = 0;
};

}  // namespace bodyopt::trainer
