// The residual table: what Direct Delta Mush leaves, learned region by region.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "runtime/basis/basis.h"
#include "trainer/train/data/data_warnings.h"
#include "trainer/train/data/unposed_shapes.h"
#include "trainer/train/features/features.h"
#include "trainer/train/regions/regions.h"
#include "trainer/train/regression/components.h"
#include "trainer/train/regression/regress.h"

namespace bodyopt::trainer {

// A column's vectors at the lanes of a block.
using BlockVectors = Eigen::Matrix<double, 3, kBlockSize>;

struct PackedEntry {
  BlendEntry entry;
  BlockVectors left;  // what it differs by
};

PackedEntry pack_entry(const BlockVectors& vectors, std::uint32_t coefficient);

// One region after its regressions: coefficients = weights^T [f, phi(f)] less their value at rest.
struct RegionModel {
  RegionWeights region;
  std::vector<std::uint32_t> features;  // feature indices, ascending
  std::vector<double> explained;        // square metres: the energy of the motion that each explains, in a linear fit
  Eigen::MatrixXd projection;           // coordinates x features, see projection.h
  Components components;                // every basis column scaled so that its largest entry is 1
  std::vector<Regression> fits;         // with ever fewer centres; never none
  std::vector<Contradiction> contradictions;
  std::vector<OutlierVertex> outliers;
};

// All of them, ready to be packed.
struct ResidualModel {
  std::vector<std::string> controls;
  std::vector<FeatureRange> ranges;
  std::vector<RegionModel> regions;
  std::uint32_t vertices = 0;
  std::vector<int> folds;  // of every training frame, see RegressionData
  FadeTable fade{};        // of all regions; empty: nothing fades
};

// Returns the training frames that cross-validation held out: all but guard frames.
std::vector<Eigen::Index> heldout_frames(const ResidualModel& model);

// Returns data for a region's regression, in its coordinates. `features`: of all training frames, `folds` and `weights`
// as RegressionData has them.
RegressionData regression_data(const FeatureSamples& features, const RegionModel& region, const std::vector<int>& folds,
                               const Eigen::VectorXd& weights = {});

// The parts that are kept of one region.
struct SelectedRegion {
  std::size_t fit = 0;
  std::vector<std::vector<std::uint32_t>> blocks;  // of each component those with an entry, ascending; empty: nothing
  std::vector<std::vector<std::uint32_t>> fine;    // of those, the ones whose rounding has an entry, too
};

// The selection for every region of a model.
using Selection = std::vector<SelectedRegion>;

struct PackedResidual {
  ResidualTable table;
  std::vector<std::size_t> regions;  // of the model: those of which anything is kept
};

// The remainder of a component's vectors in a block, once rounded to 8 bits: the sum of the squared lengths.
struct BlockRounding {
  std::uint32_t block;
  double left;
};
std::vector<BlockRounding> rounding_of(const RegionModel& region, Eigen::Index component);

PackedResidual pack_residual(const ResidualModel& model, const Selection& selection);

// Leaves out fibres that no region listens to. `first`: feature index of the first strain.
void drop_unused_fibres(StrainTable& strain, ResidualTable& residual, std::uint32_t first);

}  // namespace bodyopt::trainer
