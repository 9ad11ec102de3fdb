// Chooses the features that a region's map listens to, and the form of the map.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "assets/characters/muscles.h"
#include "trainer/train/data/samples.h"
#include "trainer/train/features/features.h"
#include "trainer/train/fit/groundwork.h"
#include "trainer/train/options.h"
#include "trainer/train/pack/residual.h"

namespace bodyopt::trainer {

// Strains where no muscle is: curves drawn across the parts of the skin that move in ways nothing explains yet.

// Pairs of curves, options.surface_curves at most, named "surface 1 along", "surface 1 across". They go along the bone
// of the joint that moves the place most, and across it. One after the other, they are put where most un-posed motion
// is left, and not near those before. It is left by a linear map of all features, fitted to other frames. Shows
// progress. Throws as train().
std::vector<Muscle> surface_curves(const SampleSet& set, const TrainOptions& options);

// How many pairs a character without muscles needs. It is 40 where a linear map of its joints leaves more than a third
// of the un-posed motion of other frames (root mean square). It is none where less is left, and of fewer than 80 or
// more than 800 frames. Shows progress. Throws as train().
int needed_surface_curves(const SampleSet& set, const TrainOptions& options);

// A curve through points on the skin, as a muscle of one fibre.
inline Muscle surface_curve(const std::string& name, std::vector<MusclePoint> path) {
  Muscle muscle;
  muscle.name = name;
  muscle.path = std::move(path);
  muscle.radius = 0;
  muscle.fibre_count = 1;
  return muscle;
}

// Tells which of the features are strains, and whether all of them are of curves that training alone put on the skin.
struct StrainFeatures {
  std::uint32_t first = 0, count = 0;
  bool of_curves = false;
};

// Sets the features, what each explains, the projection and the fits of a region whose components are there, in metres
// of positions. It takes the choice that leaves least in cross-validation. Of few frames (kFewFrames) every fold then
// has its own features, since those found on all frames know the ones they are measured on. The best choice with
// strains then stays where its finished map leaves less than the best without, strains of curves a tenth less. Where
// kernels are allowed, the map has them unless a linear one is better in cross-validation by a twentieth. `motion` (N x
// M, metres): what features and coordinates are to explain, as many principal components of the region as the map gives
// or more. There are no more coordinates than these. `folds`, `weights`: of every frame, see RegressionData.
void choose_map(const FeatureSamples& features, const StrainFeatures& strains, const FeatureChoices& choices,
                const Eigen::MatrixXd& motion, const std::vector<int>& folds, const Eigen::VectorXd& weights,
                const TrainOptions& options, RegionModel& model);

// A map of the same features and form as an earlier training found, fitted to the components that are there now.
void refit_map(const FeatureSamples& features, const std::vector<int>& folds, const Eigen::VectorXd& weights,
               const TrainOptions& options, RegionModel& model);

}  // namespace bodyopt::trainer
