#include "tests/support/trained_basis.h"

#include <utility>

namespace bodyopt {

Basis trained_basis(const trainer::SampleSet& set, const trainer::TrainOptions& options,
                    std::vector<std::string>* notes) {
  trainer::TrainingResult result = trainer::train(set, options);
  if (notes) notes->insert(notes->end(), result.notes.begin(), result.notes.end());
  return std::move(result.basis);
}

}  // namespace bodyopt
