#include "trainer/anatomy/corrections.h"

#include <nlohmann/json.hpp>

#include "assets/json_file.h"
#include "runtime/core/error.h"
#include "trainer/anatomy/inner_tissue.h"

namespace bodyopt {
namespace {

constexpr double kThickestMetres = 0.1, kLargestCorrection = 10, kLargestMuscle = 1e6;  // the last in cubic centimetres

std::string joint_of(const JsonObject& object, const Skeleton& skeleton) {
  const std::string joint = object.name("joint");
  if (skeleton.find(joint) < 0) {
    throw Error(ErrorKind::mismatch, object.path().string() + ": " + object.place() + " corrects '" + joint +
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
  object.refuse("\"region\" is '" + name + "', expected one of " + known);
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
    if (!corrections.kind) top.refuse("\"kind\" is '" + top.name("kind") + "', expected one of " + body_kind_names());
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

}  // namespace bodyopt
