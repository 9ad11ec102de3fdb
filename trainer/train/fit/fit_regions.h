// Components, features and regressions of the regions, from training frames or from an earlier training.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "trainer/train/data/data_warnings.h"
#include "trainer/train/data/samples.h"
#include "trainer/train/fit/groundwork.h"
#include "trainer/train/options.h"
#include "trainer/train/pack/residual.h"

namespace bodyopt::trainer {

// The folds and weights of every training frame, see RegressionData.
std::vector<int> training_folds(const SampleSet& set);
Eigen::VectorXd training_weights(const SampleSet& set);

// The data that every region is fitted to.
struct FitContext {
  FitContext(const SampleSet& set, const Groundwork& ground, const Layout& layout, const TrainOptions& options);

  const Groundwork& ground;
  const Layout& layout;
  const TrainOptions& options;
  std::vector<int> folds;        // training_folds
  Eigen::VectorXd weights;       // training_weights
  std::vector<FramePair> pairs;  // frames of one pose
};

// Called with every region once it is done, from any thread.
using RegionDone = std::function<void(std::size_t region, const RegionModel& model)>;

// Fits some regions (ascending) into their places of `models`. The radius within which a region sees features is chosen
// with the other hyper-parameters, by cross-validation. Shapes are read part by part of the skin, as options.memory_gib
// allows. `kept`: of what is done when it is interrupted, for the message.
void fit_regions(const FitContext& context, const std::vector<std::size_t>& regions, std::vector<RegionModel>& models,
                 const RegionDone& done, const std::string& kept);

// Brings regions of an earlier training, in their places of `models`, to these frames. `earlier`: the index each frame
// had then, -1 for new ones. Coefficients of the frames it knew stay; the others are un-posed and put on its
// components. Features, widths and penalties are those found then, and the regressions are fitted anew. Regions where
// that is not good enough are returned, as they were: they have to be fitted from the start. Their components leave
// over twice as much of new frames as the fit left of old ones, or cross-validation's error changes by a tenth. What
// was chosen by it was then chosen for other data.
std::vector<std::size_t> update_regions(const FitContext& context, const std::vector<int>& earlier,
                                        const std::vector<std::size_t>& regions, std::vector<RegionModel>& models,
                                        const RegionDone& done, const std::string& kept);

}  // namespace bodyopt::trainer
