#include "trainer/anatomy/inner_tissue.h"

#include <algorithm>

#include "base/parallel.h"
#include "geometry/mesh.h"
#include "trainer/anatomy/animal.h"
#include "trainer/anatomy/human_bones.h"

namespace bodyopt::trainer {
namespace {

using Eigen::Index;

constexpr std::array kTissueNames{"outside", "bone", "fat", "cavity", "muscle", "tendon", "other_lean"};
constexpr double kSkin = 1.6;  // millimetres

// The head's bone that is deeper than the skull is thick, above its base.
double brain_volume(const BodySurvey& survey, const HumanFrame& frame, const InnerTissue& tissue) {
  if (!frame.head) return 0;
  int samples = 0;
  for (std::size_t s = 0; s < survey.spots().size(); ++s) {
    const Spot& spot = survey.spots()[s];
    const double skull = tissue.bone[static_cast<Index>(s)] + 7 * frame.mm;
    const double forward = std::clamp((spot.point.z() - frame.head->at.z()) / (40 * frame.mm), 0.0, 1.0);
    const double base = frame.head->at.y() + (15 + 30 * forward) * frame.mm;
    samples += spot.region == BodyRegion::head && skull < 0 && spot.point.y() > base ? 1 : 0;
  }
  return samples * survey.grid().volume();
}

void find_human_tissue(BodySurvey& survey, const HumanFrame& frame, const InnerTissueOptions& options,
                       InnerTissue& tissue) {
  for (const std::string& part : frame.missing)
    tissue.notes.push_back("no joints for " + part + " were found on this side: there are no bones there");
  lay_fat(survey, human_fat_pattern(survey, frame), kSkin * frame.mm, options, tissue);
  HumanSkeleton skeleton{survey, frame};
  add_limbs(skeleton);
  const auto cavity = add_trunk(skeleton);
  add_head(skeleton);
  find_bone(survey, corrected_bones(skeleton.bones, survey.body(), options.corrections), tissue);
  tissue.brain = brain_volume(survey, frame, tissue);
  tissue.cavity.resize(survey.grid().size());
  parallel_for(survey.spots().size(),
               [&](std::size_t s) { tissue.cavity[static_cast<Index>(s)] = cavity(survey.spots()[s]); });
  tissue.landmarks = skeleton.landmarks;
}

constexpr std::array kRegionNames{"trunk", "hip",       "neck",    "head", "thigh", "calf",
                                  "foot",  "upper_arm", "forearm", "hand", "tail",  "fin"};

// The regions by BodyPart; the parts that follow are hands.
constexpr BodyRegion kRegionOfPart[] = {BodyRegion::hip,   BodyRegion::trunk,     BodyRegion::neck,
                                        BodyRegion::head,  BodyRegion::hip,       BodyRegion::thigh,
                                        BodyRegion::calf,  BodyRegion::foot,      BodyRegion::foot,
                                        BodyRegion::trunk, BodyRegion::upper_arm, BodyRegion::forearm};

BodyRegion region_of_part(BodyPart part) {
  return part < BodyPart::hand ? kRegionOfPart[static_cast<std::size_t>(part)] : BodyRegion::hand;
}

// Some rigs begin the spine at the hips.
bool stands_at_hips(const HalfBody& body, std::size_t joint) {
  constexpr double kBeside = 0.015;  // of the body's extent
  const int hip = body.find(BodyPart::thigh), other = body.find(BodyPart::thigh, BodySide::right);
  if (hip < 0 && other < 0) return false;
  const double height = body.places[static_cast<std::size_t>(hip < 0 ? other : hip)].y();
  return body.places[joint].y() < height + kBeside * longest_extent(body.vertices);
}

// J: by the roles of joints; a joint without one belongs to the region of its parent.
std::vector<BodyRegion> regions_of_joints(const HalfBody& body) {
  std::vector<BodyRegion> regions;
  for (std::size_t j = 0; j < body.joints.size(); ++j) {
    const int parent = body.joints[j].parent;
    regions.push_back(body.roles[j] ? region_of_part(body.roles[j]->part)
                      : parent >= 0 ? regions[static_cast<std::size_t>(parent)]
                                    : BodyRegion::trunk);
    const bool is_spine = body.roles[j] && body.roles[j]->part == BodyPart::spine;
    if (is_spine && stands_at_hips(body, j)) regions.back() = BodyRegion::hip;
  }
  return regions;
}

}  // namespace

const char* name_of(TissueKind kind) { return kTissueNames[static_cast<std::size_t>(kind)]; }

TissueKind InnerTissue::kind(int sample) const {
  if (bone[sample] < 0) return TissueKind::bone;
  if (fat[sample] < 0) return TissueKind::fat;
  return cavity[sample] < 0 ? TissueKind::cavity : TissueKind::other_lean;
}

InnerTissue find_inner_tissue(const HalfBody& body, const BodyGrid& grid, const InnerTissueOptions& options) {
  const HumanFrame frame = frame_of(body);
  if (options.kind != BodyKind::biped || !frame.has_leg() || !frame.has_arm())
    return find_animal_tissue(body, grid, options);
  InnerTissue tissue;
  tissue.notes = grid.notes;
  BodySurvey survey(body, grid, regions_of_joints(body));
  for (const Spot& spot : survey.spots()) tissue.region.push_back(spot.region);
  find_human_tissue(survey, frame, options, tissue);
  return tissue;
}

const char* name_of(BodyRegion region) { return kRegionNames[static_cast<std::size_t>(region)]; }

LeanSamples::LeanSamples(const BodyGrid& own_grid, const InnerTissue& own_tissue)
    : grid(own_grid), tissue(own_tissue), lean(static_cast<std::size_t>(own_grid.size()), -1) {
  for (int s = 0; s < grid.size(); ++s) {
    if (tissue.kind(s) != TissueKind::other_lean) continue;
    lean[static_cast<std::size_t>(s)] = static_cast<int>(sample.size());
    sample.push_back(s);
  }
  points = grid.points(sample, Eigen::all);
  for (const int s : sample) {
    neighbours.push_back(grid.beside(s));
    for (int& other : neighbours.back()) other = other < 0 ? -1 : lean[static_cast<std::size_t>(other)];
  }
}

}  // namespace bodyopt::trainer
