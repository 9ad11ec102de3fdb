// Frames of a clip to shapes in a dataset: what `simulate` and `improve` do.
#pragma once

#include <string>
#include <vector>

#include "cli/arguments/dataset_arguments.h"
#include "cli/arguments/field_arguments.h"
#include "trainer/simulate/simulate.h"

namespace bodyopt::cli {

struct SimulationArguments {
  std::string character, muscles, materials;
  std::string out;  // the dataset's folder
  double unit = 0;
  FieldArguments anatomy;
  TakeArguments take;
  SimulateOptions options;
};

// Simulates, and adds the take, or its new frames, to the dataset.json of the folder. Throws as simulate(), and
// Error(mismatch) where the dataset or the take is of something else.
std::vector<FrameStatus> simulate_take(const SimulationArguments& arguments);

}  // namespace bodyopt::cli
