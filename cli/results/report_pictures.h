// Pictures of held-out frames for a report.
#pragma once

#include <string>
#include <vector>

#include "report/report.h"
#include "trainer/train/judge/heldout.h"

namespace bodyopt::cli {

class ReportPictures {
 public:
  // `shapes` of the held-out frames, one at least, and their errors. All must outlive this. Throws Error(device).
  ReportPictures(const SampleSet& set, const std::vector<Positions>& shapes, const MethodReport& method,
                 const std::string& device);

  // A held-out frame: truth, result, distance. `kind`, `caption`: as PictureReport.
  PictureReport frame(const std::string& kind, std::size_t sample, const std::string& caption);
  std::vector<PictureReport> worst_and_median();
  MeanErrorReport mean_error(const VertexErrors& errors);
  // Their numbers count from 1.
  Image regions(const std::vector<RegionWeights>& regions);

 private:
  double heat_scale_mm() const;

  const SampleSet& set_;
  const std::vector<Positions>& shapes_;
  const MethodReport& method_;
  Renderer renderer_;
  std::vector<std::uint32_t> triangles_;
};

// Indices of the held-out frames by rising RMS error.
std::vector<std::size_t> by_error(const MethodReport& method);

}  // namespace bodyopt::cli
