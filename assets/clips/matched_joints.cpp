#include "assets/clips/matched_joints.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/json_file.h"

namespace bodyopt {
namespace {

// An unmatched joint that is called as one of the source's is another.
Skeleton with_names_of_source(Skeleton skeleton, const std::vector<MappedJoint>& matched) {
  for (Joint& joint : skeleton.joints) {
    const auto is_it = std::ranges::find(matched, joint.name, &MappedJoint::to);
    if (is_it != matched.end()) {
      joint.name = is_it->from;
    } else if (std::ranges::find(matched, joint.name, &MappedJoint::from) != matched.end()) {
      joint.name += " (its own)";
    }
  }
  return skeleton;
}

}  // namespace

std::vector<MappedJoint> matched_joints(const Metadata& metadata) {
  const auto text = metadata.find(kMatchedJoints);
  const Json list = text == metadata.end() ? Json() : Json::parse(text->second, nullptr, false);
  std::vector<MappedJoint> joints;
  if (!list.is_array()) return joints;
  for (const Json& joint : list) {
    if (!joint.is_object() || !joint.contains("from") || !joint.contains("to")) return {};
    if (!joint["from"].is_string() || !joint["to"].is_string()) return {};
    joints.push_back({joint["from"], joint["to"]});
  }
  return joints;
}

Clip read_clip(const std::string& source, const Basis& basis, const ClipOptions& options) {
  const std::vector<MappedJoint> matched = matched_joints(basis.metadata);
  if (matched.empty()) return read_clip(source, basis.skeleton, options);
  std::vector<MappedJoint> mapped;
  if (!options.joint_map.empty()) mapped = read_joint_map(options.joint_map);
  const auto is_own = [&](const MappedJoint& joint) { return basis.skeleton.find(joint.to) >= 0; };
  if (!mapped.empty() && std::ranges::all_of(mapped, is_own)) return read_clip(source, basis.skeleton, options);
  const auto choose = [&](std::set<std::string> names) {
    for (const MappedJoint& joint : mapped) names.insert(joint.to);
    const auto has = [&](const std::string& name) { return names.contains(name); };
    const bool has_own = std::ranges::all_of(basis.skeleton.joints, has, &Joint::name),
               has_source = std::ranges::all_of(matched, has, &MappedJoint::from);
    return has_own || !has_source ? basis.skeleton : with_names_of_source(basis.skeleton, matched);
  };
  return read_clip(source, choose, options);
}

}  // namespace bodyopt
