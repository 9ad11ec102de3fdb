// What it takes to repeat a training.
#pragma once

#include <filesystem>

#include "cli/results/measure.h"

namespace bodyopt::cli {

// `dataset_file`: the dataset.json, as the user gave it; `basis_file`: what was written. Throws Error(file).
ProvenanceReport provenance_of(const Dataset& dataset, const std::filesystem::path& dataset_file, const SampleSet& set,
                               const TrainOptions& options, const std::filesystem::path& basis_file);

}  // namespace bodyopt::cli
