#include "assets/matched_joints.h"

#include <algorithm>
#include <set>

#include "assets/bvh.h"
#include "assets/clip_source.h"
#include "assets/gltf_file.h"
#include "assets/json_file.h"

namespace bodyopt {
namespace {

using Names = std::set<std::string>;

// Of all that could be a joint; none of what is no clip.
Names names_in(const std::string& source) {
  Names names;
  const ClipSource parts = split_source(source);
  const std::string extension = lower_case_extension(parts.path);
  if (extension == ".bvh") {
    for (const BvhJoint& joint : read_bvh(parts.path).joints) names.insert(joint.name);
  } else if (extension == ".glb" || extension == ".gltf") {
    const GltfFile file(parts.path);
    for (const tinygltf::Node& node : file.model().nodes) names.insert(node.name);
  }
  return names;
}

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
  Names names = names_in(source);
  for (const MappedJoint& joint : mapped) names.insert(joint.to);
  const auto has = [&](const std::string& name) { return names.contains(name); };
  const bool has_own = std::ranges::all_of(basis.skeleton.joints, has, &Joint::name),
             has_source = std::ranges::all_of(matched, has, &MappedJoint::from);
  if (has_own || !has_source) return read_clip(source, basis.skeleton, options);
  return read_clip(source, with_names_of_source(basis.skeleton, matched), options);
}

}  // namespace bodyopt
