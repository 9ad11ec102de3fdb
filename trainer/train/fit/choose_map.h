// What a region's map listens to, and of which form it is.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "trainer/train/features/features.h"
#include "trainer/train/fit/groundwork.h"
#include "trainer/train/options.h"
#include "trainer/train/pack/residual.h"

namespace bodyopt {

// Which of the features are strains, and whether all of them are of curves that nobody but training put on the skin.
struct StrainFeatures {
  std::uint32_t first = 0, count = 0;
  bool of_curves = false;
};

// Sets the features, what each explains, the projection and the fits of a region whose components are there, in metres
// of positions. Of the choices it takes the one that leaves least in cross-validation; of few frames (kFewFrames) every
// fold has features of its own for that, since those found on all frames know the ones they are measured on, and the
// best choice with strains stays where its finished map leaves less than that of the best one without, with strains of
// curves a tenth less. Where kernels are allowed, the map has them unless a linear one is better in cross-validation by
// a twentieth. `motion` (N x M, metres): what features and coordinates are to tell, as many principal components of the
// region or more than the map gives; there are no more coordinates than these. `folds`, `weights`: of every frame, see
// RegressionData.
void choose_map(const FeatureSamples& features, const StrainFeatures& strains, const FeatureChoices& choices,
                const Eigen::MatrixXd& motion, const std::vector<int>& folds, const Eigen::VectorXd& weights,
                const TrainOptions& options, RegionModel& model);

// A map of the same features and form as an earlier training found, fitted to the components that are there now.
void refit_map(const FeatureSamples& features, const std::vector<int>& folds, const Eigen::VectorXd& weights,
               const TrainOptions& options, RegionModel& model);

}  // namespace bodyopt
