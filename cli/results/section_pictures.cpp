#include "cli/results/section_pictures.h"

#include <algorithm>
#include <numeric>

#include "cli/arguments/common.h"
#include "report/section_picture.h"
#include "runtime/core/error.h"
#include "runtime/host/rig.h"
#include "trainer/anatomy/section.h"
#include "trainer/anatomy/telling_planes.h"
#include "trainer/simulate/muscle_fibres.h"

namespace bodyopt::cli {
namespace {

// How much shorter the muscle is that is shortened most, of its length at rest.
double largest_shortening(const SampleSet& set, const Sample& sample) {
  const std::vector<Affine> skinning = skinning_matrices(set.character.skeleton, sample.pose.joints);
  double largest = 0;
  for (const Muscle& muscle : set.muscles) {
    const double rest = rest_length(muscle);
    if (rest > 0) largest = std::max(largest, 1 - path_length(muscle, skinning) / rest);
  }
  return largest;
}

// The frame, trained on or not, of which most is flexed; null where there is none.
const Sample* section_frame(const SampleSet& set) {
  const Sample* most = nullptr;
  std::pair<double, double> flexed{-1, -1};
  for (const std::vector<Sample>* samples : {&set.train, &set.heldout}) {
    for (const Sample& sample : *samples) {
      const std::vector<float>& controls = sample.pose.controls;
      const std::pair of_frame{std::accumulate(controls.begin(), controls.end(), 0.0), largest_shortening(set, sample)};
      if (of_frame <= flexed) continue;
      flexed = of_frame;
      most = &sample;
    }
  }
  return most;
}

SectionsReport draw_sections(const SampleSet& set, const Sample& sample, const AnatomyField& field) {
  constexpr int kPixels = 260;
  const TissueColours colours(set.muscles);
  const std::vector<Affine> skinning = skinning_matrices(set.character.skeleton, sample.pose.joints);
  const Positions skin = sample.shape.read();
  const auto tissue_at = [&](const Eigen::Vector3d& point) { return field.tissue_at(point); };
  std::vector<Image> pictures;
  SectionsReport report;
  for (const NamedPlane& named : telling_planes(field, kPixels)) {
    report.names.push_back(named.name);
    pictures.push_back(section_image(
        section_of(named.plane, rest_points(named.plane, set.character.vertices, set.character.triangles), tissue_at),
        colours));
    const SectionPlane moved = moved_plane(named.plane, skinning[named.joint]);
    const RestPoints rest = rest_points(moved, PosedBody{set.character, skin, skinning});
    pictures.push_back(section_image(section_of(moved, rest, tissue_at), colours));
  }
  report.take = set.takes[static_cast<std::size_t>(sample.take)];
  report.frame = sample.frame;
  report.image = numbered_sheet(pictures, 2);
  return report;
}

}  // namespace

std::optional<SectionsReport> section_pictures(const SampleSet& set, const AnatomyOptions& options) {
  const Sample* sample = set.muscles.empty() ? nullptr : section_frame(set);
  if (!sample) return std::nullopt;
  try {
    return draw_sections(set, *sample, AnatomyField(set.character, set.muscles, options));
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::mismatch) throw;
    say({std::string("the report shows no sections: ") + error.what()});
    return std::nullopt;
  }
}

}  // namespace bodyopt::cli
