#include "trainer/anatomy/animal.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/parallel.h"
#include "geometry/mesh.h"

namespace bodyopt::trainer {
namespace {

using Eigen::Vector3d;
using Use = JointLimb::Use;

constexpr int kShaftLinks = 6;
constexpr double kCover = 0.002;      // of the body's size: of skin and tendon over a bone
constexpr double kThickest = 0.012;   // of the body's size: what radii tend to in thick parts
constexpr double kShareOfPart = 0.7;  // of the radius of a thin part
constexpr double kSwelling = 1.4;     // at hinges
constexpr double kTip = 0.85;         // of the way from the last joint to the end of its skin
constexpr double kCentring = 0.8;     // how far a bone is moved from its joints to the middle of sections

std::size_t of(int joint) { return static_cast<std::size_t>(joint); }

// Two unit vectors across a third.
std::array<Vector3d, 2> across_axis(const Vector3d& axis) {
  const Vector3d one = axis.unitOrthogonal();
  return {one, axis.cross(one)};
}

// The middle of the section across an axis, as seen from a place in it; not farther than about its depth.
Vector3d section_middle(const BodyGrid& grid, const Vector3d& from, const Vector3d& axis) {
  constexpr int kRays = 12, kRounds = 3;
  constexpr double kFarthest = 2.5;  // of the least way out
  const auto [one, other] = across_axis(axis);
  Vector3d middle = from;
  for (int round = 0; round < kRounds; ++round) {
    std::array<double, kRays> ways;
    std::array<Vector3d, kRays> rays;
    for (std::size_t k = 0; k < kRays; ++k) {
      const double angle = 2 * std::numbers::pi * static_cast<double>(k) / kRays;
      rays[k] = std::cos(angle) * one + std::sin(angle) * other;
      ways[k] = way_out(grid, middle, rays[k], 60 * grid.cell);
    }
    const double most = kFarthest * (*std::ranges::min_element(ways) + grid.cell);
    Vector3d sum = Vector3d::Zero();
    for (std::size_t k = 0; k < kRays; ++k) sum += std::min(ways[k], most) * rays[k];
    middle += sum / kRays;
  }
  return middle;
}

// A bone from `from` to `to`, that moves with `joint`.
struct LongBone {
  int joint;
  Vector3d from, to;
  bool is_double = false;  // ulna and radius, tibia and fibula
  bool is_girdle = false;  // lies under the skin, not in the middle
};

// Radii are multiplied by `thickness`. Joints that a correction lets carry bone have one, too.
class LimbBones {
 public:
  LimbBones(const Animal& animal, double thickness) : animal_(animal), thickness_(thickness) {}

  std::vector<Bone> find(const AnatomyCorrections& corrections) {
    for (const auto& [joint, of] : corrections.bones) {
      if (of.carries.value_or(false)) add_asked_for(joint);
    }
    const std::vector<int> parents = bone_parents(animal_.chains);
    for (const JointLimb& limb : animal_.chains.limbs) {
      if (limb.use == Use::none || limb.use == Use::fin || !is_seen(limb)) continue;
      for (const LongBone& bone : bones_of(limb, parents)) {
        if (!is_hand(bone.joint)) add(bone);
      }
      for (const int joint : limb.joints) {
        if (is_hand(joint)) add_core(joint);
      }
    }
    for (int joint = 0; joint < static_cast<int>(animal_.survey.body().joints.size()); ++joint) {
      if (holds_piece_of_trunk(animal_, joint)) add_ribs(joint);
    }
    return std::move(bones_);
  }

 private:
  // Adds bones to the joints below, or to the end of the joint's own skin.
  void add_asked_for(const std::string& name) {
    const std::vector<NamedJoint>& joints = animal_.survey.body().joints;
    const auto found = std::ranges::find_if(joints, [&](const auto& each) { return each.name == name; });
    const int joint = static_cast<int>(found - joints.begin());
    bool has_below = false;
    for (int below = 0; below < static_cast<int>(joints.size()); ++below) {
      if (joints[of(below)].parent != joint || !animal_.chains.has_skin(below)) continue;
      has_below = true;
      add({joint, animal_.place(joint), animal_.place(below)});
    }
    if (!has_below && found != joints.end()) add(end_of(joint));
  }

  bool is_hand(int joint) const {
    return animal_.kind == BodyKind::limb && animal_.survey.regions()[of(joint)] == BodyRegion::hand;
  }

  bool is_seen(const JointLimb& limb) const { return !animal_.survey.body().has_plane || limb.is_left; }

  std::vector<LongBone> bones_of(const JointLimb& limb, const std::vector<int>& parents) const {
    std::vector<LongBone> bones;
    std::vector<bool> has_bone(parents.size(), false);
    for (const int joint : limb.joints) {
      const int above = parents[of(joint)];
      if (above < 0) continue;
      has_bone[of(above)] = true;
      const Vector3d &from = animal_.place(above), &to = animal_.place(joint);
      if ((to - from).norm() < 2e-3 * animal_.size || is_strut(limb, above, joint)) continue;
      bones.push_back(
          {above, from, to, is_double(above), is_named(animal_.name(above), {"clavicle", "collar", "scapula"})});
    }
    for (const int joint : limb.joints) {
      if (!has_bone[of(joint)] && animal_.chains.has_skin(joint) && !animal_.chains.is_excess[of(joint)])
        bones.push_back(end_of(joint));
    }
    return bones;
  }

  // Rigs reach sideways through the trunk to a limb's first joint: the girdle is there. And a limb that comes with a
  // piece of trunk has no bone from its root.
  bool is_strut(const JointLimb& limb, int above, int joint) const {
    if (above != limb.joints.front()) return false;
    if (animal_.kind == BodyKind::limb) return holds_piece_of_trunk(animal_, above);
    const Vector3d along = animal_.place(joint) - animal_.place(above);
    return limb.use == Use::leg && std::abs(along.x()) > 0.7 * along.norm();
  }

  bool is_double(int joint) const {
    return animal_.kind == BodyKind::limb &&
           is_named(animal_.name(joint), {"elbow", "forearm", "lowerarm", "shin", "calf", "knee"});
  }

  // The bone from the last joint of a limb towards the end of its skin.
  LongBone end_of(int joint) const {
    const HalfBody& body = animal_.survey.body();
    const Vector3d& from = animal_.place(joint);
    const Vector3d towards = animal_.chains.centre[of(joint)] - from;
    double reach = 0;
    for (std::size_t v = 0; v < body.weights.size(); ++v) {
      for (const JointWeight& weight : body.weights[v]) {
        if (static_cast<int>(weight.joint) != joint || weight.weight < 0.5) continue;
        const Vector3d point = body.vertices.row(static_cast<Eigen::Index>(v));
        reach = std::max(reach, (point - from).dot(towards.normalized()));
      }
    }
    return {joint, from, from + kTip * reach * towards.normalized()};
  }

  void add(const LongBone& bone) {
    const Vector3d along = (bone.to - bone.from).normalized();
    std::vector<ChainLink> links;
    for (int k = 0; k <= kShaftLinks; ++k) {
      const double u = static_cast<double>(k) / kShaftLinks;
      const Vector3d straight = bone.from + u * (bone.to - bone.from);
      if (animal_.survey.grid().sample_at(straight) < 0) continue;
      links.push_back(link(bone, straight, along, std::abs(2 * u - 1)));
    }
    if (links.size() < 2) return;
    if (!bone.is_double) return add(bone.joint, links);
    const Vector3d one = along.cross(std::abs(along.z()) < 0.9 ? Vector3d::UnitZ() : Vector3d::UnitY()).normalized();
    for (const double side : {-1.0, 1.0}) {
      std::vector<ChainLink> beside = links;
      for (ChainLink& link : beside) {
        link.place += side * 1.1 * link.radius * one;
        link.radius *= 0.75;
      }
      add(bone.joint, beside);
    }
  }

  // Moves a link towards the middle of the section, though not far where a limb leaves the trunk. It is as thick
  // as the part allows. `end`: 0 in the middle of the shaft, 1 at a hinge.
  ChainLink link(const LongBone& bone, const Vector3d& straight, const Vector3d& along, double end) const {
    constexpr double kFarthest = 0.6;  // of the part's radius
    const Vector3d middle = bone.is_girdle ? straight : section_middle(animal_.survey.grid(), straight, along);
    const double part = animal_.survey.spot(middle).depth;
    const Vector3d way = kCentring * (middle - straight);
    const double share = std::min(1.0, kFarthest * part / std::max(way.norm(), 1e-12));
    const Vector3d place = straight + share * way;
    const double most = kThickest * animal_.size, thin = kShareOfPart * part;
    const double shaft = std::min(thin * most / (thin + most), 0.25 * (bone.to - bone.from).norm());
    const double swollen = thickness_ * shaft * (1 + (kSwelling - 1) * end * end * end);
    return {place, std::min(swollen, 0.8 * animal_.survey.spot(place).depth)};
  }

  // The core of a hand whose fingers have no joints of their own.
  void add_core(int joint) {
    constexpr double kCore = 0.55;  // of the half thickness
    bones_.push_back({joint, kCover * animal_.size, [joint, far = animal_.size](const Spot& spot) {
                        return spot.joint == joint ? kCore * spot.half_thickness - spot.depth : far;
                      }});
  }

  // A shell as thin as ribs would be if they were spread over the gaps between them.
  void add_ribs(int joint) {
    constexpr double kHalf = 0.0009;  // of the body's size
    bones_.push_back({joint, kCover * animal_.size, [joint, &animal = animal_](const Spot& spot) {
                        if (spot.joint != joint) return animal.size;
                        return std::abs(rib_shell_distance(animal, spot)) - kHalf * animal.size;
                      }});
  }

  void add(int joint, const std::vector<ChainLink>& links) {
    bones_.push_back(
        {joint, kCover * animal_.size, [links](const Spot& spot) { return chain_distance(spot.point, links); }});
  }

  const Animal& animal_;
  double thickness_;
  std::vector<Bone> bones_;
};

using Eigen::Index;

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

// The places where limbs leave the axis: hind and fore, the mean of either.
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

// J. Joints of no limb are the tail behind the hips, the neck before the shoulders, or the trunk.
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

// Shares of fat under the skin, by BodyRegion: thick on the trunk, thin on heads and lower limbs.
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

// Bones are so thick that they take the share of the body that skeletons do, within reason, whatever its build. A lone
// limb keeps its first bones: what comes with it says nothing of them.
void lay_bones(const Animal& animal, const AnimalCavity& cavity, const AnatomyCorrections& corrections,
               InnerTissue& tissue) {
  constexpr int kTries = 4;
  constexpr double kThinnest = 0.6, kThickestBones = 1.8;
  double thickness = 1;
  for (int k = 0; k < kTries; ++k) {
    std::vector<Bone> bones = skull_bones(animal);
    for (const auto& more : {LimbBones(animal, thickness).find(corrections), girdle_bones(animal, thickness),
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
  if (std::ranges::none_of(tissue.region, [](BodyRegion r) { return r == BodyRegion::head; }))
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

}  // namespace bodyopt::trainer
