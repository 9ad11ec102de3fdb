#include "trainer/muscle_models/mapping.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "assets/clips/joint_roles.h"
#include "trainer/muscle_models/human_mappings.h"

namespace bodyopt::trainer::muscle_models {
namespace {

Eigen::Vector3d read_axis(const JsonObject& json, const char* key) {
  const std::string text = json.text(key);
  if (text.size() != 2 || (text[0] != '+' && text[0] != '-') || text[1] < 'x' || text[1] > 'z') {
    json.refuse("'", key, "' is '", text, "', expected an axis such as \"+y\" or \"-z\"");
  }
  return (text[0] == '-' ? -1.0 : 1.0) * Eigen::Vector3d::Unit(text[1] - 'x');
}

Eigen::Matrix3d read_axes(const JsonObject& json, const char* up_key, const char* forward_key) {
  const Eigen::Vector3d up = read_axis(json, up_key), forward = read_axis(json, forward_key);
  if (up.dot(forward) != 0) json.refuse("'", up_key, "' and '", forward_key, "' are the same axis");
  Eigen::Matrix3d axes;
  axes << up, forward, up.cross(forward);
  return axes;
}

std::vector<std::string> read_names(const JsonObject& json, const char* key) {
  std::vector<std::string> names;
  for (const Json& name : json.array(key)) {
    if (!name.is_string() || name.get<std::string>().empty()) {
      json.refuse("'", key, "' is not a list of names");
    }
    names.push_back(name.get<std::string>());
  }
  return names;
}

NamePair read_pair(const JsonObject& json, const Json& pair, const char* key) {
  if (!pair.is_array() || pair.size() != 2 || !pair[0].is_string() || !pair[1].is_string()) {
    json.refuse("'", key, "' holds something else than two names");
  }
  return {pair[0].get<std::string>(), pair[1].get<std::string>()};
}

SegmentMap read_segment_map(const JsonObject& json) {
  json.allow({"segments", "joint", "centres", "source"});
  if (json.has("source")) json.text("source");
  SegmentMap map;
  map.segments = read_names(json, "segments");
  if (map.segments.empty()) json.refuse("'segments' is empty");
  map.joint = json.name("joint");
  for (const Json& pair : json.array("centres")) map.centres.push_back(read_pair(json, pair, "centres"));
  if (map.centres.size() < 2) json.refuse("'centres' names fewer than two joint centres: size and turn are unknown");
  return map;
}

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
  const auto found = std::ranges::find_if(roles, [&](const auto& entry) { return entry.second == role; });
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

std::string Mapping::mirrored_joint(const std::string& joint) const {
  for (const auto& [here, there] : mirror_joints) {
    const std::size_t place = joint.find(here);
    if (place != std::string::npos) return joint.substr(0, place) + there + joint.substr(place + here.size());
  }
  return joint;
}

Mapping read_mapping(const std::filesystem::path& path) {
  const Json json = read_json(path, "bodyopt-muscle-mapping-1");
  const JsonObject top(json, path, "the file");
  top.allow({"schema", "source", "model_up", "model_forward", "character_up", "character_forward", "segments",
             "leave_out", "mirror_joints", "mirror_muscles"});
  if (top.has("source")) top.text("source");
  Mapping mapping;
  mapping.file = path.string();
  mapping.model_axes = read_axes(top, "model_up", "model_forward");
  mapping.character_axes = read_axes(top, "character_up", "character_forward");
  for (const JsonObject& segment : top.objects("segments")) mapping.segments.push_back(read_segment_map(segment));
  mapping.leave_out = read_names(top, "leave_out");
  if (top.has("mirror_joints")) {
    for (const Json& pair : top.array("mirror_joints")) {
      mapping.mirror_joints.push_back(read_pair(top, pair, "mirror_joints"));
      if (mapping.mirror_joints.back()[0].empty()) top.refuse("'mirror_joints' replaces an empty text");
    }
    mapping.mirror_muscles = read_pair(top, top.array("mirror_muscles"), "mirror_muscles");
    if (mapping.mirror_muscles[0] == mapping.mirror_muscles[1]) top.refuse("'mirror_muscles' has two equal endings");
  }
  return mapping;
}

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

}  // namespace bodyopt::trainer::muscle_models
