#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "geometry/extent.h"
#include "trainer/anatomy/animal.h"
#include "trainer/anatomy/fat.h"

namespace bodyopt {
namespace {

using Eigen::Index;
using Eigen::Vector3d;
using Use = JointLimb::Use;

constexpr double kSkinOfSize = 0.0009;                   // thickness of the skin, as a share of the body's size
constexpr double kFatOfSize = 0.004;                     // where the pattern is 1, at a scale of 1
constexpr double kRibs = 0.005;                          // of a body's size: trunk, whatever limb's skin is over it
constexpr double kLimbOfBody = 0.43;                     // of a body's size: an arm with its shoulder, alone
constexpr double kFewestBone = 0.075, kMostBone = 0.12;  // of the volume: what thickness of bones is chosen for

// Limbs by how far along them a joint is: an upper and a lower part, and what stands or grasps.
BodyRegion region_of_limb(const HalfBody& body, const JointChains& chains, int joint) {
  const JointLimb& limb = chains.limbs[static_cast<std::size_t>(chains.limb[static_cast<std::size_t>(joint)])];
  if (limb.use == Use::fin || limb.use == Use::none) return BodyRegion::fin;
  const std::string& name = body.joints[static_cast<std::size_t>(joint)].name;
  if (!body.has_plane && is_named(name, {"torso", "body", "chest", "clavicle"})) return BodyRegion::trunk;
  if (!body.has_plane && is_named(name, {"shoulder", "upperarm"})) return BodyRegion::upper_arm;
  if (!body.has_plane && is_named(name, {"wrist", "hand", "finger", "thumb"})) return BodyRegion::hand;
  const auto length_to = [&](int to) {
    double length = 0;
    for (; to != limb.joints.front() && to >= 0; to = chains.parent[static_cast<std::size_t>(to)]) {
      const auto j = static_cast<std::size_t>(to), above = static_cast<std::size_t>(chains.parent[j]);
      length += (body.places[j] - body.places[above]).norm();
    }
    return length;
  };
  double whole = 0;
  for (const int each : limb.joints) whole = std::max(whole, length_to(each));
  const double along = whole > 0 ? length_to(joint) / whole : 0;
  const int part = along < 0.35 ? 0 : (along < 0.75 ? 1 : 2);
  constexpr BodyRegion kLeg[] = {BodyRegion::thigh, BodyRegion::calf, BodyRegion::foot};
  constexpr BodyRegion kArm[] = {BodyRegion::upper_arm, BodyRegion::forearm, BodyRegion::hand};
  return (limb.use == Use::leg ? kLeg : kArm)[part];
}

// Where limbs leave the axis: hind and fore, on average of either.
struct LimbRoots {
  Vector3d hind, fore;
  // Along the body, 0 at the hind limbs, 1 at the fore limbs.
  double along(const Vector3d& point) const { return (point - hind).dot(fore - hind) / (fore - hind).squaredNorm(); }
};

std::optional<LimbRoots> limb_roots(const JointChains& chains) {
  if (chains.axis.size() < 2) return std::nullopt;
  const auto centre = [&](int joint) { return chains.centre[static_cast<std::size_t>(joint)]; };
  const Vector3d along = (centre(chains.axis.back()) - centre(chains.axis.front())).normalized();
  std::vector<Vector3d> roots;
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const JointLimb& limb : chains.limbs) {
    if (limb.use == Use::none || limb.use == Use::fin) continue;
    roots.push_back(centre(limb.joints.front()));
    low = std::min(low, roots.back().dot(along));
    high = std::max(high, roots.back().dot(along));
  }
  Vector3d sum[2] = {Vector3d::Zero(), Vector3d::Zero()};
  double count[2] = {0, 0};
  for (const Vector3d& root : roots) {
    const int side = root.dot(along) > (low + high) / 2 ? 1 : 0;
    sum[side] += root;
    ++count[side];
  }
  if (count[0] == 0 || count[1] == 0) return std::nullopt;
  return LimbRoots{sum[0] / count[0], sum[1] / count[1]};
}

// J. What is not of a limb: the tail behind the hips, the neck before the shoulders, the trunk.
std::vector<BodyRegion> animal_regions(const HalfBody& body, const JointChains& chains) {
  constexpr double kNear = 0.12, kMostNeck = 0.25;  // of the way from hips to shoulders; of the skin
  std::vector<BodyRegion> regions(chains.parent.size(), BodyRegion::trunk);
  const auto roots = limb_roots(chains);
  for (const int joint : chains.axis) {
    const auto j = static_cast<std::size_t>(joint);
    const double along = roots ? roots->along(chains.centre[j]) : 0.5;
    if (along < kNear) regions[j] = along < -kNear ? BodyRegion::tail : BodyRegion::hip;
    if (along > 1 + kNear && chains.skin[j] < kMostNeck) regions[j] = BodyRegion::neck;
    if (is_named(body.joints[j].name, {"tail"})) regions[j] = BodyRegion::tail;
    if (is_named(body.joints[j].name, {"neck"})) regions[j] = BodyRegion::neck;
  }
  for (std::size_t j = 0; j < regions.size(); ++j) {
    if (chains.limb[j] >= 0) regions[j] = region_of_limb(body, chains, static_cast<int>(j));
    if (chains.is_head[j]) regions[j] = BodyRegion::head;
  }
  return regions;
}

// Of fat under the skin, by BodyRegion: thick on the trunk, thin on heads and lower limbs.
constexpr std::array<double, kBodyRegions> kFatShares{1, 1.2, 0.6, 0.35, 0.8, 0.35, 0.2, 0.6, 0.35, 0.2, 0.8, 0.2};

// V, metres. Limbs that are thin have less than the trunk at any place of theirs.
Eigen::VectorXd animal_fat_pattern(const BodySurvey& survey, double size) {
  const Eigen::MatrixXd weights = survey.region_weights();
  Eigen::VectorXd pattern = Eigen::VectorXd::Zero(weights.rows());
  for (std::size_t r = 0; r < kFatShares.size(); ++r) pattern += kFatShares[r] * weights.col(static_cast<Index>(r));
  return kFatOfSize * size * pattern;
}

double bone_share(const InnerTissue& tissue) {
  return static_cast<double>((tissue.bone.array() < 0).count()) /
         static_cast<double>(std::max<Index>(1, tissue.bone.size()));
}

// Of a body of any build: bones so thick that they take the share of it that skeletons do, within reason. What comes
// with a lone limb says nothing of its bones.
void lay_bones(const Animal& animal, const AnimalCavity& cavity, const AnatomyCorrections& corrections,
               InnerTissue& tissue) {
  constexpr int kTries = 4;
  constexpr double kThinnest = 0.6, kThickestBones = 1.8;
  double thickness = 1;
  for (int k = 0; k < kTries; ++k) {
    std::vector<Bone> bones = skull_bones(animal);
    for (const auto& more : {limb_bones(animal, corrections, thickness), girdle_bones(animal, thickness),
                             axis_bones(animal, cavity, thickness)})
      bones.insert(bones.end(), more.begin(), more.end());
    find_bone(animal.survey, corrected_bones(bones, animal.survey.body(), corrections), tissue);
    const double share = bone_share(tissue), wanted = std::clamp(share, kFewestBone, kMostBone);
    if (share == wanted || share == 0 || animal.kind == BodyKind::limb) break;
    thickness = std::clamp(thickness * std::pow(wanted / share, 0.7), kThinnest, kThickestBones);
  }
}

void note_missing(const Animal& animal, const AnimalCavity& cavity, InnerTissue& tissue) {
  if ((tissue.bone.array() >= 0).all())
    tissue.notes.push_back("no bones: no chain of joints runs through the body (a single joint, or joints outside it)");
  if (animal.kind == BodyKind::limb) return;
  if (animal.spine.empty())
    tissue.notes.push_back("no spine, ribs and cavity: no joints in the middle of the body move its skin");
  if (std::none_of(tissue.region.begin(), tissue.region.end(), [](BodyRegion r) { return r == BodyRegion::head; }))
    tissue.notes.push_back("no skull: no joint is named as a head");
  if (!animal.spine.empty() && !cavity.empty() && !(tissue.cavity.array() < 0).any())
    tissue.notes.push_back("no room for a cavity between hips and shoulders");
}

}  // namespace

InnerTissue find_animal_tissue(const HalfBody& body, const BodyGrid& grid, const InnerTissueOptions& options) {
  InnerTissue tissue;
  tissue.notes = grid.notes;
  const JointChains chains = find_chains(body);
  BodySurvey survey(body, grid, animal_regions(body, chains));
  for (const Spot& spot : survey.spots()) tissue.region.push_back(spot.region);
  const double size = longest_extent(body.vertices) / (options.kind == BodyKind::limb ? kLimbOfBody : 1);
  lay_fat(survey, animal_fat_pattern(survey, size), kSkinOfSize * size, options, tissue);
  const SpineCurve spine(survey, chains, options.kind);
  const Animal animal{survey, chains, spine, options.kind, size};
  const AnimalCavity cavity(animal);
  lay_bones(animal, cavity, options.corrections, tissue);
  tissue.cavity.resize(grid.size());
  parallel_for(survey.spots().size(), [&](std::size_t s) {
    const double distance = tissue.cavity[static_cast<Index>(s)] = cavity.distance(survey.spots()[s]);
    if (distance < kRibs * size && !is_trunk(tissue.region[s])) tissue.region[s] = BodyRegion::trunk;
  });
  note_missing(animal, cavity, tissue);
  return tissue;
}

}  // namespace bodyopt
