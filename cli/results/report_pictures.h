// Pictures of held-out frames for a report.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "report/report.h"
#include "runtime/deformer/deformer.h"
#include "trainer/anatomy/field.h"
#include "trainer/train/data/samples.h"
#include "trainer/train/judge/test_errors.h"

namespace bodyopt::cli {

class ReportPictures {
 public:
  // `shapes` of the held-out frames, one at least, by the basis, and their errors. All must outlive this. Throws
  // Error(device).
  ReportPictures(const trainer::SampleSet& set, const std::vector<Positions>& shapes, const ErrorStatistics& errors,
                 const Basis& basis, const std::string& device);

  // A held-out frame: truth, Direct Delta Mush, result, distance. `kind`, `caption`: as PictureReport.
  report::PictureReport frame(const std::string& kind, std::size_t sample, const std::string& caption);
  std::vector<report::PictureReport> worst_and_median();
  report::MeanErrorReport mean_error(const trainer::VertexErrors& errors);
  // None where no frame is flexed, or the basis has learned nothing of it.
  std::optional<report::FlexReport> flexed();
  // Their numbers count from 1.
  draw::Image regions(const std::vector<RegionWeights>& regions);

 private:
  double heat_scale_mm() const;

  const trainer::SampleSet& set_;
  const std::vector<Positions>& shapes_;
  const ErrorStatistics& errors_;
  const Basis& basis_;
  Deformer skinning_;  // Direct Delta Mush alone
  draw::Renderer renderer_;
  std::span<const std::uint32_t> triangles_;
};

// Indices of the held-out frames by rising RMS error.
std::vector<std::size_t> by_error(const ErrorStatistics& errors);

// Pairs are at rest, and in the frame of which most is flexed by controls. Where nothing is flexed, it is that of the
// muscle shortest beside its length at rest. None without muscles or frames, and, with a line on standard error, where
// nothing is known of the inside.
std::optional<report::SectionsReport> section_pictures(const trainer::SampleSet& set,
                                                       const trainer::AnatomyOptions& options);

}  // namespace bodyopt::cli
