#include "cli/results/report_pictures.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "geometry/table_rows.h"
#include "report/pictures.h"
#include "report/plots.h"
#include "report/region_picture.h"

namespace bodyopt::cli {
namespace {

constexpr std::uint32_t kSkinWidth = 780, kSkinHeight = 900;  // of a panel

}  // namespace

ReportPictures::ReportPictures(const SampleSet& set, const std::vector<Positions>& shapes, const MethodReport& method,
                               const std::string& device)
    : set_(set), shapes_(shapes), method_(method), renderer_(device) {
  const auto* data = set.character.triangles.data();
  triangles_.assign(data, data + set.character.triangles.size());
}

// One scale for all pictures, so that their colours can be compared; the few larger errors saturate.
double ReportPictures::heat_scale_mm() const { return std::max(0.5, std::ceil(4 * method_.p99) / 2); }

PictureReport ReportPictures::frame(const std::string& kind, std::size_t sample, const std::string& caption) {
  constexpr std::uint32_t kWidth = 520, kHeight = 600;
  const std::vector<float> truth = floats_of(set_.heldout[sample].shape.read()), result = floats_of(shapes_[sample]);
  const PosePair pose{triangles_, truth, result};
  PictureReport picture;
  picture.kind = kind;
  picture.take = set_.takes[static_cast<std::size_t>(set_.heldout[sample].take)];
  picture.frame = set_.heldout[sample].frame;
  picture.rms_mm = method_.frame_rms[sample];
  picture.max_mm = method_.frame_max[sample];
  picture.heat_scale_mm = heat_scale_mm();
  picture.caption = caption;
  const Camera camera = frame_pose(pose, {-0.75f, 0.2f, 1.0f}, static_cast<float>(kWidth) / kHeight);
  picture.image = triptych(renderer_, pose, picture.heat_scale_mm, camera, kWidth, kHeight);
  return picture;
}

std::vector<PictureReport> ReportPictures::worst_and_median() {
  const std::vector<std::size_t> order = by_error(method_);
  return {frame("worst", order.back(), "the held-out frame with the largest RMS error"),
          frame("median", order[order.size() / 2], "half of the held-out frames are better, half are worse")};
}

MeanErrorReport ReportPictures::mean_error(const VertexErrors& errors) {
  const std::vector<float> skin = floats_of(set_.character.vertices);
  MeanErrorReport report;
  report.largest_mm = errors.mean.maxCoeff();
  report.heat_scale_mm = heat_scale(report.largest_mm);
  std::vector<double> scaled;
  for (const double mm : errors.mean) scaled.push_back(mm / report.heat_scale_mm);
  report.image = heat_on_skin(renderer_, skin, triangles_, scaled, kSkinWidth, kSkinHeight);
  return report;
}

Image ReportPictures::regions(const std::vector<RegionWeights>& regions) {
  const std::vector<float> skin = floats_of(set_.character.vertices);
  std::vector<DrawnRegion> drawn;
  for (const RegionWeights& region : regions) drawn.push_back({region.vertices, region.weights});
  return region_picture(renderer_, skin, triangles_, drawn, region_colours(drawn, skin.size() / 3), kSkinWidth,
                        kSkinHeight);
}

std::vector<std::size_t> by_error(const MethodReport& method) {
  std::vector<std::size_t> order(method.frame_rms.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return method.frame_rms[a] < method.frame_rms[b]; });
  return order;
}

}  // namespace bodyopt::cli
