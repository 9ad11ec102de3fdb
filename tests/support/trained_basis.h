// A training of which a test wants the basis alone.
#pragma once

#include <string>
#include <vector>

#include "trainer/train/fit/train.h"

namespace bodyopt {

// `notes`: gets those of the training.
Basis trained_basis(const trainer::SampleSet& set, const trainer::TrainOptions& options,
                    std::vector<std::string>* notes = nullptr);

}  // namespace bodyopt
