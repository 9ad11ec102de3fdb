#include "cli/results/report_pictures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "cli/arguments/common.h"
#include "geometry/mesh.h"
#include "report/pictures.h"
#include "report/region_picture.h"
#include "runtime/basis/basis.h"
#include "runtime/core/error.h"
#include "runtime/host/rig.h"
#include "trainer/anatomy/section.h"
#include "trainer/simulate/muscle_fibres.h"

namespace bodyopt::cli {
namespace {

constexpr std::uint32_t kSkinWidth = 780, kSkinHeight = 900;  // of a panel

// Welded. `controls`: in place of the pose's own.
Positions skin_of(const Character& character, Deformer& deformer, Pose pose, const std::vector<float>& controls) {
  pose.controls = controls;
  return welded_from_output(character, deformer.evaluate({&pose, 1}).positions.data());
}

float flexing(const trainer::Sample& sample) {
  return std::accumulate(sample.pose.controls.begin(), sample.pose.controls.end(), 0.0f);
}

// The first frame, trained on or not, of which most is measured; null where none has more than `most`.
template <typename Amount, typename Measure>
const trainer::Sample* frame_of_most(const trainer::SampleSet& set, Amount most, const Measure& measure) {
  const trainer::Sample* found = nullptr;
  for (const std::vector<trainer::Sample>* samples : {&set.train, &set.heldout}) {
    for (const trainer::Sample& sample : *samples) {
      const Amount amount = measure(sample);
      if (!(amount > most)) continue;
      most = amount;
      found = &sample;
    }
  }
  return found;
}

// Controls above 0, falling.
std::vector<std::pair<std::string, double>> flexed_controls(const trainer::SampleSet& set,
                                                            const trainer::Sample& sample) {
  std::vector<std::pair<std::string, double>> flexed;
  for (std::size_t c = 0; c < sample.pose.controls.size(); ++c) {
    if (sample.pose.controls[c] > 0) flexed.emplace_back(set.controls[c], sample.pose.controls[c]);
  }
  std::ranges::stable_sort(flexed, std::greater{}, &std::pair<std::string, double>::second);
  return flexed;
}

// How much shorter the muscle is that is shortened most, of its length at rest.
double largest_shortening(const trainer::SampleSet& set, const trainer::Sample& sample) {
  const std::vector<Affine> skinning = skinning_matrices(set.character.skeleton, sample.pose.joints);
  double largest = 0;
  for (const Muscle& muscle : set.muscles) {
    const double rest = trainer::rest_length(muscle);
    if (rest > 0) largest = std::max(largest, 1 - trainer::path_length(muscle, skinning) / rest);
  }
  return largest;
}

// The frame, trained on or not, of which most is flexed; null where there is none.
const trainer::Sample* section_frame(const trainer::SampleSet& set) {
  return frame_of_most(set, std::pair{-1.0, -1.0}, [&](const trainer::Sample& sample) {
    const std::vector<float>& controls = sample.pose.controls;
    return std::pair{std::accumulate(controls.begin(), controls.end(), 0.0), largest_shortening(set, sample)};
  });
}

report::SectionsReport draw_sections(const trainer::SampleSet& set, const trainer::Sample& sample,
                                     const trainer::AnatomyField& field) {
  constexpr int kPixels = 260;
  const trainer::TissueColours colours(set.muscles);
  const std::vector<Affine> skinning = skinning_matrices(set.character.skeleton, sample.pose.joints);
  const Positions skin = sample.shape.read();
  const auto tissue_at = [&](const Eigen::Vector3d& point) { return field.tissue_at(point); };
  std::vector<draw::Image> pictures;
  report::SectionsReport report;
  for (const trainer::NamedPlane& named : trainer::telling_planes(field, kPixels)) {
    report.names.push_back(named.name);
    pictures.push_back(report::section_image(
        trainer::section_of(
            named.plane, trainer::rest_points(named.plane, set.character.vertices, set.character.triangles), tissue_at),
        colours));
    const trainer::SectionPlane moved = trainer::moved_plane(named.plane, skinning[named.joint]);
    const trainer::RestPoints rest = trainer::rest_points(moved, trainer::PosedBody{set.character, skin, skinning});
    pictures.push_back(report::section_image(trainer::section_of(moved, rest, tissue_at), colours));
  }
  report.take = set.take_of(sample);
  report.frame = sample.frame;
  report.image = report::numbered_sheet(pictures, 2);
  return report;
}

}  // namespace

ReportPictures::ReportPictures(const trainer::SampleSet& set, const std::vector<Positions>& shapes,
                               const ErrorStatistics& errors, const Basis& basis, const std::string& device)
    : set_(set),
      shapes_(shapes),
      errors_(errors),
      basis_(basis),
      skinning_(trainer::without_residual(basis), {.name = "cpu"}),
      renderer_(device),
      triangles_(report::flat(set.character.triangles)) {}

// One scale for all pictures, so that their colours can be compared; the few larger errors saturate.
double ReportPictures::heat_scale_mm() const { return std::max(0.5, std::ceil(4 * errors_.p99) / 2); }

report::PictureReport ReportPictures::frame(const std::string& kind, std::size_t sample, const std::string& caption) {
  constexpr std::uint32_t kWidth = 520, kHeight = 600;
  const std::vector<float> truth = floats_of(set_.heldout[sample].shape.read()), result = floats_of(shapes_[sample]);
  const std::vector<float> skinning = floats_of(skin_of(set_.character, skinning_, set_.heldout[sample].pose, {}));
  const report::PosePair pose{triangles_, truth, result, skinning};
  report::PictureReport picture;
  picture.kind = kind;
  picture.take = set_.take_of(set_.heldout[sample]);
  picture.frame = set_.heldout[sample].frame;
  picture.rms_mm = errors_.frame_rms[sample];
  picture.max_mm = errors_.frame_max[sample];
  picture.heat_scale_mm = heat_scale_mm();
  picture.caption = caption;
  const draw::Camera camera = report::frame_pose(pose, {-0.75f, 0.2f, 1.0f}, static_cast<float>(kWidth) / kHeight);
  picture.image = report::comparison(renderer_, pose, picture.heat_scale_mm, camera, kWidth, kHeight);
  return picture;
}

std::vector<report::PictureReport> ReportPictures::worst_and_median() {
  const std::vector<std::size_t> order = by_error(errors_);
  return {frame("worst", order.back(), "the held-out frame with the largest RMS error"),
          frame("median", order[order.size() / 2], "half of the held-out frames are better, half are worse")};
}

report::MeanErrorReport ReportPictures::mean_error(const trainer::VertexErrors& errors) {
  const std::vector<float> skin = floats_of(set_.character.vertices);
  report::MeanErrorReport report;
  report.largest_mm = errors.mean.maxCoeff();
  report.heat_scale_mm = report::heat_scale(report.largest_mm);
  std::vector<double> scaled;
  for (const double mm : errors.mean) scaled.push_back(mm / report.heat_scale_mm);
  report.image = report::heat_on_skin(renderer_, skin, triangles_, scaled, kSkinWidth, kSkinHeight);
  return report;
}

std::optional<report::FlexReport> ReportPictures::flexed() {
  constexpr std::uint32_t kWidth = 520, kHeight = 600;
  const trainer::Sample* sample = frame_of_most(set_, 0.0f, flexing);
  if (sample == nullptr || basis_.residual.controls.empty()) return {};
  Deformer full(basis_, {.name = "cpu"});
  const std::vector<float> none(sample->pose.controls.size(), 0.0f);
  const Positions relaxed = skin_of(set_.character, full, sample->pose, none);
  const Positions tense = skin_of(set_.character, full, sample->pose, sample->pose.controls);
  report::FlexReport report;
  report.take = set_.take_of(*sample);
  report.frame = sample->frame;
  report.controls = flexed_controls(set_, *sample);
  report.max_mm = 1000 * (tense - relaxed).rowwise().norm().maxCoeff();
  report.heat_scale_mm = report::heat_scale(report.max_mm);
  const std::vector<float> before = floats_of(relaxed), after = floats_of(tense);
  const report::PosePair pose{triangles_, before, after};
  std::array<float, 3> direction = report::towards_worst(pose);
  direction[1] = std::clamp(direction[1], -0.2f, 0.4f);  // nobody looks at a character from below
  const draw::Camera camera = report::frame_pose(pose, direction, static_cast<float>(kWidth) / kHeight);
  report.image = report::comparison(renderer_, pose, report.heat_scale_mm, camera, kWidth, kHeight);
  return report;
}

draw::Image ReportPictures::regions(const std::vector<RegionWeights>& regions) {
  const std::vector<float> skin = floats_of(set_.character.vertices);
  std::vector<report::DrawnRegion> drawn;
  for (const RegionWeights& region : regions) drawn.push_back({region.vertices, region.weights});
  return report::region_picture(renderer_, skin, triangles_, drawn, report::region_colours(drawn, skin.size() / 3),
                                kSkinWidth, kSkinHeight)
      .image;
}

std::vector<std::size_t> by_error(const ErrorStatistics& errors) {
  std::vector<std::size_t> order(errors.frame_rms.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t k) { return errors.frame_rms[k]; });
  return order;
}

std::optional<report::SectionsReport> section_pictures(const trainer::SampleSet& set,
                                                       const trainer::AnatomyOptions& options) {
  const trainer::Sample* sample = set.muscles.empty() ? nullptr : section_frame(set);
  if (!sample) return std::nullopt;
  try {
    return draw_sections(set, *sample, trainer::AnatomyField(set.character, set.muscles, options));
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::mismatch) throw;
    say({std::string("the report shows no sections: ") + error.what()});
    return std::nullopt;
  }
}

}  // namespace bodyopt::cli
