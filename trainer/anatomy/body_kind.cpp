#include "trainer/anatomy/body_kind.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/json_file.h"
#include "geometry/mend_surface.h"
#include "geometry/mesh.h"
#include "runtime/core/error.h"
#include "trainer/anatomy/inner_tissue.h"
#include "trainer/anatomy/joint_chains.h"

namespace bodyopt::trainer {
namespace {

constexpr std::array kKindNames{"biped", "quadruped", "bird", "snake", "fish", "many_legs", "limb"};

using Use = JointLimb::Use;

// Whether joints have the names of a human's: hips, and thighs or upper arms.
bool has_human_names(const HalfBody& body) {
  const auto has = [&](BodyPart part) {
    return std::ranges::any_of(body.roles, [&](const auto& role) { return role && role->part == part; });
  };
  return has(BodyPart::hips) && (has(BodyPart::thigh) || has(BodyPart::upper_arm));
}

bool has_name(const HalfBody& body, std::initializer_list<std::string_view> words) {
  return std::ranges::any_of(body.joints, [&](const NamedJoint& joint) { return is_named(joint.name, words); });
}

bool has_pairs(const JointChains& chains) {
  const auto has = [&](bool is_left) {
    return std::ranges::any_of(chains.limbs,
                               [&](const JointLimb& limb) { return limb.use != Use::none && limb.is_left == is_left; });
  };
  return has(true) && has(false);
}

// Does the trunk stand rather than lie? It runs from the roots of its legs to those of its arms, or to its head.
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

constexpr double kThickestMetres = 0.1, kLargestCorrection = 10, kLargestMuscle = 1e6;  // the last in cubic centimetres

std::string joint_of(const JsonObject& object, const Skeleton& skeleton) {
  const std::string joint = object.name("joint");
  if (skeleton.find(joint) < 0) {
    throw Error(ErrorKind::mismatch, object.path(), ": ", object.place(), " corrects '", joint,
                "', which the character has no joint of; was it renamed?");
  }
  return joint;
}

std::string region_of(const JsonObject& object) {
  const std::string name = object.name("region");
  std::string known;
  for (int r = 0; r < kBodyRegions; ++r) {
    const std::string region = name_of(static_cast<BodyRegion>(r));
    if (region == name) return name;
    known += (known.empty() ? "" : ", ") + region;
  }
  object.refuse("\"region\" is '", name, "', expected one of ", known);
}

std::vector<JsonObject> objects_of(const JsonObject& top, const char* key) {
  return top.has(key) ? top.objects(key) : std::vector<JsonObject>{};
}

void read_fat(const JsonObject& object, const Skeleton& skeleton, AnatomyCorrections& corrections) {
  object.allow({"region", "joint", "factor"});
  if (object.has("region") == object.has("joint")) object.refuse("expected either \"region\" or \"joint\"");
  const double factor = object.number("factor", 0, kLargestCorrection);
  if (object.has("region")) {
    corrections.region_fat[region_of(object)] = factor;
  } else {
    corrections.joint_fat[joint_of(object, skeleton)] = factor;
  }
}

void read_muscle(const JsonObject& object, AnatomyCorrections& corrections) {
  constexpr double kCubicCentimetres = 1e-6;
  object.allow({"muscle", "volume", "factor"});
  if (object.has("volume") == object.has("factor")) object.refuse("expected either \"volume\" (in cm3) or \"factor\"");
  AnatomyCorrections::OfMuscle& of = corrections.muscles[object.name("muscle")];
  if (object.has("volume")) of.volume = kCubicCentimetres * object.number("volume", 1e-3, kLargestMuscle);
  if (object.has("factor")) of.factor = object.number("factor", 1e-3, kLargestCorrection);
}

}  // namespace

const char* name_of(BodyKind kind) { return kKindNames[static_cast<std::size_t>(kind)]; }

std::optional<BodyKind> body_kind_of(std::string_view name) {
  const auto found = std::ranges::find(kKindNames, name);
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

AnatomyCorrections::OfBone AnatomyCorrections::of_bone(const std::string& joint) const {
  const auto found = bones.find(joint);
  return found == bones.end() ? OfBone{} : found->second;
}

AnatomyCorrections read_corrections(const std::filesystem::path& path, const Skeleton& skeleton) {
  const Json json = read_json(path, "bodyopt-anatomy-corrections-1");
  const JsonObject top(json, path, "the file");
  top.allow({"schema", "kind", "body_fat", "bones", "fat", "muscles"});
  AnatomyCorrections corrections;
  if (top.has("kind")) {
    corrections.kind = body_kind_of(top.name("kind"));
    if (!corrections.kind) top.refuse("\"kind\" is '", top.name("kind"), "', expected one of ", body_kind_names());
  }
  if (top.has("body_fat")) corrections.body_fat = top.number("body_fat", 0.02, 0.6);
  for (const JsonObject& object : objects_of(top, "bones")) {
    object.allow({"joint", "carries", "thicker"});
    AnatomyCorrections::OfBone& of = corrections.bones[joint_of(object, skeleton)];
    if (object.has("carries")) of.carries = object.boolean("carries");
    if (object.has("thicker")) of.thicker = object.number("thicker", -kThickestMetres, kThickestMetres);
  }
  for (const JsonObject& object : objects_of(top, "fat")) read_fat(object, skeleton, corrections);
  for (const JsonObject& object : objects_of(top, "muscles")) read_muscle(object, corrections);
  return corrections;
}

}  // namespace bodyopt::trainer
