#include "assets/joint_map.h"

#include <nlohmann/json.hpp>
#include <set>

#include "assets/json_file.h"

namespace bodyopt {

std::vector<MappedJoint> read_joint_map(const std::filesystem::path& path) {
  const Json json = read_json(path, "bodyopt-joint-map-1");
  const JsonObject top(json, path, "the file");
  top.allow({"schema", "joints"});
  const std::vector<JsonObject> list = top.objects("joints");
  if (list.empty()) top.refuse("maps no joint in 'joints'");
  std::vector<MappedJoint> joints;
  std::set<std::string> from, to;
  for (const JsonObject& object : list) {
    object.allow({"from", "to"});
    const MappedJoint joint{object.name("from"), object.name("to")};
    if (!from.insert(joint.from).second) object.refuse("maps '" + joint.from + "' of the clip for the second time");
    if (!to.insert(joint.to).second) object.refuse("maps to '" + joint.to + "' for the second time");
    joints.push_back(joint);
  }
  return joints;
}

}  // namespace bodyopt
