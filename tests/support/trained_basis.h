// A training of which a test wants the basis alone.
#pragma once

#include <string>
#include <vector>

#include "trainer/train/fit/train.h"

namespace bodyopt {

// `notes`: gets those of the training.
inline Basis trained_basis(const SampleSet& set, const TrainOptions& options,
                           std::vector<std::string>* notes = nullptr) {
  TrainingResult result = train(set, options);
  if (notes) notes->insert(notes->end(), result.notes.begin(), result.notes.end());
  return std::move(result.basis);
}

}  // namespace bodyopt
