// From a dataset to a basis.
#pragma once

#include <string>
#include <vector>

#include "geometry/region_weights.h"
#include "runtime/basis/basis.h"
#include "trainer/train/data/samples.h"
#include "trainer/train/options.h"

namespace bodyopt {

// The regions that train() would fit: those painted, and those chosen. A partition of unity on welded vertices, each
// with a name of its own. Shows progress. Throws as train().
std::vector<RegionWeights> training_regions(const SampleSet& set, const TrainOptions& options);

// The full training. Never looks at set.heldout. Shows progress. Throws Error(mismatch) when there is too little data,
// or where it is not sound, Error(file) where what is kept cannot be read or written. `notes`: gets what
// the user should know of an update.
Basis train(const SampleSet& set, const TrainOptions& options, std::vector<std::string>* notes = nullptr);

// What train() has to say of the data, one sentence each, for the user: shapes that contradict each other, stray
// vertices, controls that never change, too few frames.
std::vector<std::string> training_warnings(const Basis& basis);

}  // namespace bodyopt
