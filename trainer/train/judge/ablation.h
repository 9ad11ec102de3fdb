// What each part of the model is worth, and how its peers do: all trained on the same frames, all held against the same
// held-out ones.
#pragma once

#include <string>
#include <vector>

#include "dataset/results.h"
#include "runtime/basis/basis.h"
#include "trainer/train/data/samples.h"
#include "trainer/train/fit/train.h"
#include "trainer/train/options.h"

namespace bodyopt {

// The first two rows and the last of the table below: linear blending, Direct Delta Mush, and `full`, trained in so
// many seconds. Needs held-out frames.
std::vector<MethodResult> compare_with_skinning(const SampleSet& set, const Basis& full, double seconds);

// `full`: what these options trained in so many seconds. The others may have as many bytes as it has, and smooth as far
// as it does; `unmade`: gets the names of those that learn nothing within these bytes. Needs held-out frames.
std::vector<MethodResult> ablate(const SampleSet& set, const TrainOptions& options, const TrainingResult& full,
                                 double seconds, std::vector<std::string>& unmade);

}  // namespace bodyopt
