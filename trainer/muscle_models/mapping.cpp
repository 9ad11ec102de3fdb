#include "trainer/muscle_models/mapping.h"

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

#include "assets/json_file.h"

namespace bodyopt::muscle_models {
namespace {

Eigen::Vector3d read_axis(const JsonObject& json, const char* key) {
  const std::string text = json.text(key);
  if (text.size() != 2 || (text[0] != '+' && text[0] != '-') || text[1] < 'x' || text[1] > 'z') {
    json.refuse(std::string("'") + key + "' is '" + text + "', expected an axis such as \"+y\" or \"-z\"");
  }
  return (text[0] == '-' ? -1.0 : 1.0) * Eigen::Vector3d::Unit(text[1] - 'x');
}

Eigen::Matrix3d read_axes(const JsonObject& json, const char* up_key, const char* forward_key) {
  const Eigen::Vector3d up = read_axis(json, up_key), forward = read_axis(json, forward_key);
  if (up.dot(forward) != 0) json.refuse(std::string("'") + up_key + "' and '" + forward_key + "' are the same axis");
  Eigen::Matrix3d axes;
  axes << up, forward, up.cross(forward);
  return axes;
}

std::vector<std::string> read_names(const JsonObject& json, const char* key) {
  std::vector<std::string> names;
  for (const Json& name : json.array(key)) {
    if (!name.is_string() || name.get<std::string>().empty()) {
      json.refuse(std::string("'") + key + "' is not a list of names");
    }
    names.push_back(name.get<std::string>());
  }
  return names;
}

NamePair read_pair(const JsonObject& json, const Json& pair, const char* key) {
  if (!pair.is_array() || pair.size() != 2 || !pair[0].is_string() || !pair[1].is_string()) {
    json.refuse(std::string("'") + key + "' holds something else than two names");
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

}  // namespace bodyopt::muscle_models
