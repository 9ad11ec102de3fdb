// A training and what it says of itself and of the held-out frames: the figures of `train` and `demo`.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "cli/arguments/common.h"
#include "dataset/compare.h"
#include "report/report.h"
#include "runtime/basis/levels.h"
#include "runtime/deformer/deformer.h"
#include "trainer/anatomy/field.h"
#include "trainer/proxy/build_proxy.h"
#include "trainer/train/data/samples.h"
#include "trainer/train/fit/train.h"
#include "trainer/train/judge/test_errors.h"
#include "trainer/train/options.h"

namespace bodyopt::cli {

// Pictures of held-out frames for a report.

class ReportPictures {
 public:
  // `shapes` of the held-out frames, one at least, by the basis, and their errors. All must outlive this. Throws
  // Error(device).
  ReportPictures(const SampleSet& set, const std::vector<Positions>& shapes, const ErrorStatistics& errors,
                 const Basis& basis, const std::string& device);

  // A held-out frame: truth, Direct Delta Mush, result, distance. `kind`, `caption`: as PictureReport.
  PictureReport frame(const std::string& kind, std::size_t sample, const std::string& caption);
  std::vector<PictureReport> worst_and_median();
  MeanErrorReport mean_error(const VertexErrors& errors);
  // None where no frame is flexed, or the basis has learned nothing of it.
  std::optional<FlexReport> flexed();
  // Their numbers count from 1.
  Image regions(const std::vector<RegionWeights>& regions);

 private:
  double heat_scale_mm() const;

  const SampleSet& set_;
  const std::vector<Positions>& shapes_;
  const ErrorStatistics& errors_;
  const Basis& basis_;
  Deformer skinning_;  // Direct Delta Mush alone
  Renderer renderer_;
  std::span<const std::uint32_t> triangles_;
};

// Indices of the held-out frames by rising RMS error.
std::vector<std::size_t> by_error(const ErrorStatistics& errors);

// Pairs are at rest, and in the frame of which most is flexed by controls. Where nothing is flexed, it is that of the
// muscle shortest beside its length at rest. None without muscles or frames, and, with a line on standard error, where
// nothing is known of the inside.
std::optional<SectionsReport> section_pictures(const SampleSet& set, const AnatomyOptions& options);

struct Training {
  TrainingResult result;
  double seconds = 0;
  std::vector<MethodResult> methods;  // linear blending, Direct Delta Mush, any others, the basis; none without
                                      // held-out frames
  UnposingResidual unposing;
};

// Trains, says what training has to say, writes the basis, and holds it against others: all of them with `ablate`.
// `unit`: that of the character.
Training train_and_measure(const SampleSet& set, const TrainOptions& options, bool ablate, double unit,
                           const std::string& out);

// The methods, a line each.
std::string method_table(const std::vector<MethodResult>& methods);

// Poses of the held-out frames.
std::vector<Pose> heldout_poses(const SampleSet& set);

// The report of a training, but for its provenance. `shapes`: of the held-out frames, by the basis; `pictures_on`: the
// Vulkan device that draws pictures, empty for none.
ReportData report_of(const SampleSet& set, const Training& training, const std::vector<Positions>& shapes,
                     const std::string& pictures_on);

// `dataset_file`: the dataset.json, as the user gave it; `basis_file`: what was written. Throws Error(file).
ProvenanceReport provenance_of(const Dataset& dataset, const std::filesystem::path& dataset_file, const SampleSet& set,
                               const TrainOptions& options, const std::filesystem::path& basis_file);

// A list with an entry per level: what was measured of it when it was made, and its time of a frame, measured now.
Json levels_info(const std::vector<Level>& levels, const ProxyReport& report);
// Formats levels_info() as text.
std::string level_table(const Json& levels);

}  // namespace bodyopt::cli
