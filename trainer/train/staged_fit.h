// The whole fit, stage by stage: what an earlier training kept is used, what is missing is fitted.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "trainer/train/fit_regions.h"
#include "trainer/train/residual.h"
#include "trainer/train/train.h"
#include "trainer/train/training_store.h"

namespace bodyopt {

class StagedFit {
 public:
  // `notes`: what the user should know of what was used. All must outlive this.
  StagedFit(const SampleSet& set, const TrainOptions& options, std::vector<std::string>& notes);

  // Of the earlier training that is brought to these frames; else as the options have it, 0 where they leave it open.
  double smoothing_radius() const { return updates_ ? earlier_->smoothing_radius : options_.smoothing_radius; }

  // Of the frames that the earlier training knew.
  EarlierFeatures earlier_features() const;

  // Layout and regions; shows progress. As train(): the same with and without an interruption.
  Layout layout(const Groundwork& ground);
  std::vector<RegionModel> regions(const Groundwork& ground, const Layout& layout);
  // After layout(): whether the fit is that of an earlier training brought to these frames.
  bool is_update(const Groundwork& ground) const { return key_ != training_key(keys_, ground.base.radius); }

 private:
  bool can_update() const;
  bool features_are_known(const Groundwork& ground) const;
  void keep(const Groundwork& ground, const Layout& layout) const;
  std::vector<std::size_t> update(const FitContext& context, std::vector<RegionModel>& models,
                                  const std::vector<std::size_t>& missing, const RegionDone& done,
                                  const std::string& kept);

  const SampleSet& set_;
  const TrainOptions& options_;
  std::vector<std::string>& notes_;
  TrainingStore store_;
  TrainingKeys keys_;
  std::optional<KeptLayout> earlier_;
  std::vector<int> earlier_frames_;  // of every frame its number in the earlier training, -1: new
  bool updates_ = false;
  std::uint64_t key_ = 0;
};

}  // namespace bodyopt
