// What each part of the model is worth, and how its peers do: all trained on the same frames, all held against the same
// held-out ones.
#pragma once

#include <string>
#include <vector>

#include "dataset/compare.h"
#include "runtime/basis/basis.h"
#include "trainer/train/data/samples.h"
#include "trainer/train/fit/train.h"
#include "trainer/train/options.h"

namespace bodyopt {

struct AblationRow {
  std::string name;
  ErrorStatistics errors;
  double bytes_per_vertex = 0;  // of the tables a frame needs; on linear blending without what strains need of DDM
  std::uint32_t coefficients = 0;
  double seconds = 0;  // of training
};

// The first two rows and the last of the table below: linear blending, Direct Delta Mush, and `full`, trained in so
// many seconds. Needs held-out frames.
std::vector<AblationRow> compare_with_skinning(const SampleSet& set, const Basis& full, double seconds);

// `full`: what these options trained in so many seconds. The others may have as many bytes as it has, and smooth as far
// as it does; `unmade`: gets the names of those that learn nothing within these bytes. Needs held-out frames.
std::vector<AblationRow> ablate(const SampleSet& set, const TrainOptions& options, const TrainingResult& full,
                                double seconds, std::vector<std::string>& unmade);

}  // namespace bodyopt
