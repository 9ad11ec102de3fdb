#include "trainer/anatomy/section_table.h"

#include <nlohmann/json.hpp>
#include <numbers>

#include "trainer/anatomy/human_tables.h"
#include "trainer/anatomy/muscle_targets.h"

namespace bodyopt {
namespace {

constexpr std::pair<const char*, BodyPart> kLimbJoints[] = {
    {"thigh", BodyPart::thigh},         {"shin", BodyPart::shin},       {"foot", BodyPart::foot},
    {"upper_arm", BodyPart::upper_arm}, {"forearm", BodyPart::forearm}, {"hand", BodyPart::hand}};

BodyPart read_joint(const JsonObject& json, const char* key) {
  const std::string name = json.name(key);
  for (const auto& [known, part] : kLimbJoints) {
    if (name == known) return part;
  }
  json.refuse("'" + name + "' is no joint of a limb");
}

std::vector<std::string> read_matching_names(const JsonObject& json) {
  std::vector<std::string> names;
  for (const Json& name : json.array("names")) names.push_back(matching_name(name.get<std::string>()));
  return names;
}

LimbSections read_limb(const JsonObject& json) {
  json.allow({"from", "to", "about", "source", "muscles"});
  LimbSections limb{read_joint(json, "from"), read_joint(json, "to"), json.name("about") == "bone", {}};
  for (const JsonObject& row : json.objects("muscles")) {
    row.allow({"names", "at"});
    LimbSections::OfMuscle muscle{read_matching_names(row), {}};
    for (const Json& place : row.array("at")) {
      if (!place.is_array() || place.size() != 3) row.refuse("'at' holds something else than [along, angle, share]");
      muscle.places.push_back(
          {place[0].get<double>(), place[1].get<double>() * std::numbers::pi / 180, place[2].get<double>()});
    }
    if (muscle.places.size() < 2) row.refuse("'at' has fewer than two places");
    limb.muscles.push_back(std::move(muscle));
  }
  return limb;
}

LandmarkPath read_path(const JsonObject& json) {
  json.allow({"names", "points"});
  LandmarkPath path{read_matching_names(json), {}};
  for (const Json& point : json.array("points")) {
    path.points.emplace_back();
    if (point != "own") path.points.back() = read_landmark_point(JsonObject(point, json.path(), json.place()));
  }
  if (path.points.size() < 2) json.refuse("'points' are fewer than two");
  return path;
}

}  // namespace

const SectionTable& section_table() {
  static const SectionTable table = [] {
    const std::filesystem::path path = "rigs/human/muscle_sections.json";
    const Json json = parse_json(kMuscleSections, path, "bodyopt-muscle-sections-1");
    const JsonObject top(json, path, "the file");
    SectionTable read;
    for (const JsonObject& limb : top.objects("limbs")) read.limbs.push_back(read_limb(limb));
    for (const JsonObject& one : top.objects("paths")) read.paths.push_back(read_path(one));
    return read;
  }();
  return table;
}

}  // namespace bodyopt
