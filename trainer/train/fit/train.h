// Trains a basis from a dataset.
#pragma once

#include <string>
#include <vector>

#include "geometry/region_weights.h"
#include "runtime/basis/basis.h"
#include "trainer/train/data/samples.h"
#include "trainer/train/options.h"
#include "trainer/train/pack/trade_off.h"

namespace bodyopt::trainer {

// The regions that train() would fit: those painted, and those chosen. A partition of unity on welded vertices, each
// with a name of its own. Shows progress. Throws as train().
std::vector<RegionWeights> training_regions(const SampleSet& set, const TrainOptions& options);

// A region as it was fitted, whether the basis keeps anything of it or not.
struct RegionFit {
  std::string name, joint;       // joint: that moves its skin most
  std::size_t vertices = 0;      // of which it has any weight
  double motion_rms_mm = 0;      // un-posed, over its vertices and all training frames
  double validation_rms_mm = 0;  // of that what cross-validation left
};

// The share of un-posed motion that a muscle's strains explain beyond the features chosen before them.
struct MuscleShare {
  std::string name;
  double percent = 0;  // 0: no region listens to it
};

// The results of a training.
struct TrainingResult {
  Basis basis;                         // its metadata tell most of the rest, for who reads the file
  std::vector<RegionWeights> regions;  // as training_regions()
  std::vector<TradeOffPoint> curve;    // the bases of other sizes that there could be
  std::vector<RegionFit> fits;         // of all regions, in the order of `regions`
  std::vector<MuscleShare> muscles;    // by name
  double expected_mm = 0;              // see expected_error
  double smoothing_radius = 0;         // of Direct Delta Mush, metres
  // Warnings about the data for the user, one sentence each: shapes that contradict each other, outliers, controls that
  // never change, too few frames.
  std::vector<std::string> warnings;
  std::vector<std::string> notes;  // of an update
};

// The full training. Never looks at set.heldout. Shows progress. Throws Error(mismatch) when there is too little data,
// or where it is not sound, Error(file) where what is kept cannot be read or written.
TrainingResult train(const SampleSet& set, const TrainOptions& options);

}  // namespace bodyopt::trainer
