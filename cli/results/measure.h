// A training and what it says of itself and of the held-out frames: the figures of `train` and `demo`.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "cli/arguments/common.h"
#include "dataset/compare.h"
#include "report/report.h"
#include "runtime/basis/levels.h"
#include "trainer/proxy/build_proxy.h"
#include "trainer/train/fit/train.h"
#include "trainer/train/judge/test_errors.h"
#include "trainer/train/options.h"

namespace bodyopt::cli {

struct Training {
  trainer::TrainingResult result;
  double seconds = 0;
  std::vector<MethodResult> methods;  // linear blending, Direct Delta Mush, any others, the basis; none without
                                      // held-out frames
  trainer::UnposingResidual unposing;
};

// Trains, says what training has to say, writes the basis, and holds it against others: all of them with `ablate`.
// `unit`: that of the character.
Training train_and_measure(const trainer::SampleSet& set, const trainer::TrainOptions& options, bool ablate,
                           double unit, const std::string& out);

// The methods, a line each.
std::string method_table(const std::vector<MethodResult>& methods);

// Poses of the held-out frames.
std::vector<Pose> heldout_poses(const trainer::SampleSet& set);

// The report of a training, but for its provenance. `shapes`: of the held-out frames, by the basis; `pictures_on`: the
// Vulkan device that draws pictures, empty for none.
report::ReportData report_of(const trainer::SampleSet& set, const Training& training,
                             const std::vector<Positions>& shapes, const std::string& pictures_on);

// `dataset_file`: the dataset.json, as the user gave it; `basis_file`: what was written. Throws Error(file).
report::ProvenanceReport provenance_of(const Dataset& dataset, const std::filesystem::path& dataset_file,
                                       const trainer::SampleSet& set, const trainer::TrainOptions& options,
                                       const std::filesystem::path& basis_file);

// A list with an entry per level: what was measured of it when it was made, and its time of a frame, measured now.
Json levels_info(const std::vector<Level>& levels, const trainer::ProxyReport& report);
// Formats levels_info() as text.
std::string level_table(const Json& levels);

}  // namespace bodyopt::cli
