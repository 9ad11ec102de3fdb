// The residual table: what Direct Delta Mush leaves, learned region by region.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "runtime/basis/basis.h"
#include "trainer/train/components.h"
#include "trainer/train/contradictions.h"
#include "trainer/train/coverage.h"
#include "trainer/train/features.h"
#include "trainer/train/regions.h"
#include "trainer/train/regress.h"
#include "trainer/train/train.h"
#include "trainer/train/unposed_shapes.h"

namespace bodyopt {

// One region after its regression: coefficients = weights^T [f, phi(f)] less their value at rest.
struct RegionModel {
  RegionWeights region;
  std::vector<std::uint32_t> features;  // feature indices, ascending
  std::vector<double> worth;            // square metres: the energy of the motion that each explains, in a linear fit
  Components components;                // every basis column scaled so that its largest entry is 1
  Regression regression;
  ErrorModel expected;  // of the region's energy, square metres
  std::vector<Contradiction> contradictions;
};

// All of them, ready to be packed.
struct ResidualModel {
  std::vector<std::string> controls;
  std::vector<FeatureRange> ranges;
  std::vector<RegionModel> regions;
  std::uint32_t vertices = 0;
};

// Components, then features and regression of every region. The radius within which a region sees features is chosen
// with the other hyper-parameters, by cross-validation. Shapes are read part by part of the skin, as options.memory_gib
// allows. `features` and `takes`: of all the training frames.
ResidualModel fit_residual(const Character& character, UnposedShapes& shapes, const std::vector<RegionWeights>& regions,
                           const std::vector<FeatureGroup>& groups, const FeatureSamples& features,
                           const std::vector<int>& takes, const TrainOptions& options);

// Leaves out fibres that no region listens to, from the table and from the model's features. `first`: feature index of
// the first strain.
void drop_unused_fibres(StrainTable& strain, ResidualModel& model, std::uint32_t first);

struct PackedResidual {
  ResidualTable table;
  std::vector<std::size_t> regions;  // of the model: those that move anything by more than is negligible
};

// The first `components` of every region. Entries that move no vertex of their block by more than `negligible` (metres,
// root mean square over the training frames) are left out.
PackedResidual pack_residual(const ResidualModel& model, int components, double negligible);

}  // namespace bodyopt
