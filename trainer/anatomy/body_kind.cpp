#include "trainer/anatomy/body_kind.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/closed_skin.h"
#include "geometry/extent.h"
#include "trainer/anatomy/joint_chains.h"

namespace bodyopt {
namespace {

constexpr std::array kKindNames{"biped", "quadruped", "bird", "snake", "fish", "many_legs", "limb"};

using Use = JointLimb::Use;

// Whether joints have the names of a human's: hips, and thighs or upper arms.
bool has_human_names(const HalfBody& body) {
  const auto has = [&](BodyPart part) {
    return std::any_of(body.roles.begin(), body.roles.end(),
                       [&](const auto& role) { return role && role->part == part; });
  };
  return has(BodyPart::hips) && (has(BodyPart::thigh) || has(BodyPart::upper_arm));
}

bool has_name(const HalfBody& body, std::initializer_list<std::string_view> words) {
  return std::any_of(body.joints.begin(), body.joints.end(),
                     [&](const NamedJoint& joint) { return is_named(joint.name, words); });
}

bool has_pairs(const JointChains& chains) {
  const auto has = [&](bool is_left) {
    return std::any_of(chains.limbs.begin(), chains.limbs.end(),
                       [&](const JointLimb& limb) { return limb.use != Use::none && limb.is_left == is_left; });
  };
  return has(true) && has(false);
}

// Does the trunk stand rather than lie? From the roots of its legs to those of its arms, or to its head.
bool stands_upright(const JointChains& chains) {
  Eigen::Vector3d low = Eigen::Vector3d::Zero(), high = low;
  double legs = 0, arms = 0;
  for (const JointLimb& limb : chains.limbs) {
    const Eigen::Vector3d& root = chains.centre[static_cast<std::size_t>(limb.joints.front())];
    if (limb.use == Use::leg) low += root, ++legs;
    if (limb.use == Use::arm || limb.use == Use::wing) high += root, ++arms;
  }
  if (legs == 0 || (arms == 0 && chains.axis.empty())) return true;
  const Eigen::Vector3d top =
      arms > 0 ? Eigen::Vector3d(high / arms) : chains.centre[static_cast<std::size_t>(chains.axis.back())];
  const Eigen::Vector3d along = top - low / legs;
  return along.y() > 0.7 * along.norm();
}

// How many times longer than thick a body without limbs is: along its joints, where it is curled.
double slenderness(const HalfBody& body, const JointChains& chains) {
  double length = 0;
  for (std::size_t k = 1; k < chains.axis.size(); ++k) {
    const auto one = static_cast<std::size_t>(chains.axis[k - 1]), other = static_cast<std::size_t>(chains.axis[k]);
    length += (chains.centre[other] - chains.centre[one]).norm();
  }
  length = std::max(length, longest_extent(body.vertices));
  const double volume = std::abs(enclosed_volume(body.vertices, body.triangles));
  return volume > 0 ? length / std::sqrt(volume / length) : 1;
}

std::string times(double ratio) { return std::to_string(static_cast<int>(std::lround(ratio))) + " times"; }

RecognisedKind kind_without_legs(const HalfBody& body, const JointChains& chains) {
  constexpr double kSnake = 8, kCompressed = 1.25;
  constexpr std::size_t kFewestVertebrae = 5;
  if (has_name(body, {"fin", "fins", "gill", "gills"})) return {BodyKind::fish, "joints are named as fins or gills"};
  if (!has_pairs(chains) && has_name(body, {"elbow", "wrist", "forearm", "knee", "shin", "ankle"}))
    return {BodyKind::limb, "its joints are named as those of one limb, and none lies on another side"};
  if (chains.count(Use::wing) > 0 && has_pairs(chains))
    return {BodyKind::bird, "it has flat limbs, wings, and none that reaches the ground"};
  if (chains.count(Use::arm) > 0 && has_pairs(chains))
    return {BodyKind::biped, "it has arms, and no limbs that reach the ground"};
  if (chains.count(Use::fin) > 0) return {BodyKind::fish, "its limbs are short and flat, as fins"};
  const double ratio = slenderness(body, chains);
  if (ratio >= kSnake && chains.axis.size() >= kFewestVertebrae)
    return {BodyKind::snake, "it has no limbs and is " + times(ratio) + " longer than thick"};
  const Eigen::RowVector3d sides = box_sides(body.vertices);
  if (sides.y() > kCompressed * sides.x() && sides.z() > sides.y() && chains.axis.size() > 2)
    return {BodyKind::fish, "it has no limbs, is higher than wide and " + times(ratio) + " longer than thick"};
  return {BodyKind::limb, "no limbs leave its chain of joints"};
}

RecognisedKind kind_of(const HalfBody& body, const JointChains& chains) {
  const int legs = chains.count(Use::leg), wings = chains.count(Use::wing);
  const std::string pairs = std::to_string(2 * legs) + " limbs reach the ground";
  if (has_human_names(body) && (legs <= 1 || stands_upright(chains)) && wings == 0)
    return {BodyKind::biped, "its joints are named as those of a human"};
  if (legs > 2) return {BodyKind::many_legs, pairs};
  if (legs == 2) return {BodyKind::quadruped, pairs};
  if (legs == 0 || !has_pairs(chains)) return kind_without_legs(body, chains);
  if (has_name(body, {"wing", "wings", "beak"})) return {BodyKind::bird, "joints are named as wings or a beak"};
  if (wings > 0) return {BodyKind::bird, "two limbs reach the ground, and two others are flat, as wings"};
  return {BodyKind::biped, pairs};
}

}  // namespace

const char* name_of(BodyKind kind) { return kKindNames[static_cast<std::size_t>(kind)]; }

std::optional<BodyKind> body_kind_of(std::string_view name) {
  const auto found = std::find(kKindNames.begin(), kKindNames.end(), name);
  if (found == kKindNames.end()) return std::nullopt;
  return static_cast<BodyKind>(found - kKindNames.begin());
}

std::string body_kind_names() {
  std::string names;
  for (const char* name : kKindNames) names += (names.empty() ? "" : ", ") + std::string(name);
  return names;
}

RecognisedKind recognise_kind(const Character& character) {
  const HalfBody body = body_in_frame(character);
  return kind_of(body, find_chains(body));
}

std::vector<bool> carries_bone(const Character& character) {
  const std::vector<int> bones = bone_parents(find_chains(body_in_frame(character)));
  std::vector<bool> carries;
  for (std::size_t j = 0; j < bones.size(); ++j)
    carries.push_back(bones[j] >= 0 && bones[j] == character.skeleton.joints[j].parent);
  return carries;
}

}  // namespace bodyopt
