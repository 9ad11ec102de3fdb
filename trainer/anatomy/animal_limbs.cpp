#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "trainer/anatomy/animal.h"
#include "trainer/anatomy/shapes.h"

namespace bodyopt {
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
    const double most = kFarthest * (*std::min_element(ways.begin(), ways.end()) + grid.cell);
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
  // To the joints below, or to the end of its skin.
  void add_asked_for(const std::string& name) {
    const std::vector<NamedJoint>& joints = animal_.survey.body().joints;
    const auto found = std::find_if(joints.begin(), joints.end(), [&](const auto& each) { return each.name == name; });
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

  // From the last joint of a limb towards the end of its skin.
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

  // Towards the middle of the section, where a limb leaves the trunk not far, and as thick as the part allows. end: 0
  // in the middle of the shaft, 1 at a hinge.
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

}  // namespace

std::vector<Bone> limb_bones(const Animal& animal, const AnatomyCorrections& corrections, double thickness) {
  return LimbBones(animal, thickness).find(corrections);
}

}  // namespace bodyopt
