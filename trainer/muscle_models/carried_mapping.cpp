#include "trainer/muscle_models/carried_mapping.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "assets/joint_roles.h"
#include "trainer/muscle_models/human_mappings.h"
#include "trainer/muscle_models/mapping.h"

namespace bodyopt::muscle_models {
namespace {

using Roles = std::map<std::string, JointRole>;  // by joint

// `file_json`: of a mapping that read_mapping() accepts.
std::set<std::string> named_by(const Json& file_json) {
  std::set<std::string> names;
  for (const Json& segment : file_json.at("segments")) {
    names.insert(segment.at("joint").get<std::string>());
    for (const Json& centre : segment.at("centres")) names.insert(centre[1].get<std::string>());
  }
  return names;
}

Roles roles_by_name(const std::vector<NamedJoint>& joints) {
  const std::vector<std::optional<JointRole>> roles = joint_roles(joints);
  Roles by_name;
  for (std::size_t j = 0; j < joints.size(); ++j) {
    if (roles[j]) by_name.emplace(joints[j].name, *roles[j]);
  }
  return by_name;
}

std::optional<std::string> joint_of(const Roles& roles, const JointRole& role) {
  const auto found = std::find_if(roles.begin(), roles.end(), [&](const auto& entry) { return entry.second == role; });
  return found == roles.end() ? std::nullopt : std::optional(found->first);
}

JointRole other_side(JointRole role) {
  if (role.side != BodySide::middle) role.side = role.side == BodySide::left ? BodySide::right : BodySide::left;
  return role;
}

std::string name_of(const JointRole& role) {
  constexpr const char* kParts[] = {"hips",         "spine",         "neck",        "head",         "hip joint",
                                    "thigh",        "shin",          "foot",        "toe",          "clavicle",
                                    "upper arm",    "forearm",       "hand",        "palm",         "thumb",
                                    "index finger", "middle finger", "ring finger", "little finger"};
  constexpr const char* kSides[] = {"", "left ", "right "};
  return kSides[static_cast<std::size_t>(role.side)] + std::string(kParts[static_cast<std::size_t>(role.part)]);
}

// Joints that the rig does not have are nowhere.
bool is_unplaced(const NamePair& joints, const Skeleton& skeleton) {
  const int first = skeleton.find(joints[0]), second = skeleton.find(joints[1]);
  if (first < 0 || second < 0) return false;
  const Vec3 a = bind_place(skeleton, static_cast<std::size_t>(first));
  const Vec3 b = bind_place(skeleton, static_cast<std::size_t>(second));
  return !(std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]) > kNearestCentres);
}

// `json`: of a mapping that read_mapping() accepts.
CarriedMapping carry(const std::string& name, const Json& json, const Skeleton& skeleton) {
  CarriedMapping result{name, json, {}, {}};
  std::vector<NamedJoint> named;
  for (const std::string& joint : named_by(json)) named.push_back({joint, -1});
  const Roles there = roles_by_name(named), here = roles_by_name(named_joints(skeleton));
  std::map<std::string, std::string> exchange, source;
  Json mirror = Json::array();
  for (const NamedJoint& joint : named) {
    const auto role = there.find(joint.name);
    const std::optional<std::string> found = role == there.end() ? std::nullopt : joint_of(here, role->second);
    exchange[joint.name] = found.value_or(joint.name);
    if (!found) {
      source[joint.name] =
          "no name of this rig's joints tells which does what '" + joint.name + "' does: write it here";
      result.unknown.push_back(joint.name);
      continue;
    }
    source[joint.name] = "the " + name_of(role->second) + " by its name";
    const std::optional<std::string> other = joint_of(here, other_side(role->second));
    if (role->second.side != BodySide::middle && other) mirror.push_back({*found, *other});
  }
  for (Json& segment : result.json.at("segments")) {
    const auto joint = segment["joint"].get<std::string>();
    segment["joint"] = exchange.at(joint);
    segment["source"] = source.at(joint);
    for (Json& centre : segment.at("centres")) centre[1] = exchange.at(centre[1].get<std::string>());
    const NamePair first_two = {segment["centres"][0][1].get<std::string>(),
                                segment["centres"][1][1].get<std::string>()};
    if (is_unplaced(first_two, skeleton)) {
      result.unplaced.push_back({segment["segments"][0].get<std::string>(), first_two});
    }
  }
  if (json.contains("mirror_joints") && !json.at("mirror_joints").empty()) result.json["mirror_joints"] = mirror;
  result.json["source"] = name + ", its joints exchanged for those of this rig that do the same";
  return result;
}

}  // namespace

CarriedMapping carried_mapping(const std::filesystem::path& path, const Skeleton& skeleton) {
  read_mapping(path);  // throws where it is none
  return carry(path.filename().string(), read_json(path, "bodyopt-muscle-mapping-1"), skeleton);
}

std::vector<CarriedMapping> first_mappings(const Skeleton& skeleton) {
  std::vector<CarriedMapping> mappings;
  for (const auto& [name, text] :
       {std::pair("gait2392.json", kGait2392Mapping), std::pair("myo_arm.json", kMyoArmMapping)}) {
    const Json json = Json::parse(text);
    CarriedMapping mapping = carry(name, json, skeleton);
    if (2 * mapping.unknown.size() <= named_by(json).size()) mappings.push_back(std::move(mapping));
  }
  return mappings;
}

}  // namespace bodyopt::muscle_models
