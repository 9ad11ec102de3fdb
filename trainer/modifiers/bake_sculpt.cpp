// Sculpt: what an artist's mesh of one pose has beyond the skin that the basis gives there, un-posed.
#include <algorithm>
#include <nlohmann/json.hpp>
#include <numbers>

#include "assets/characters/character.h"
#include "assets/clips/clip.h"
#include "base/json_file.h"
#include "base/wording.h"
#include "runtime/basis/character_unit.h"
#include "runtime/core/error.h"
#include "runtime/core/json.h"
#include "trainer/modifiers/bake_modifier.h"
#include "trainer/modifiers/joint_holds.h"
#include "trainer/modifiers/measure_modifiers.h"
#include "trainer/train/skinning/unpose.h"

namespace bodyopt::trainer {
namespace {

constexpr double kNoticed = 0.1;  // share of what was sculpted that a joint must hold to be listened to

Pose sculpted_pose(const BakeInput& input) {
  const std::string source = (input.folder / input.parameters.name("clip")).string();
  ClipOptions options;
  options.unit = clip_unit(source, kept_unit(input.basis));
  if (input.parameters.has("up")) options.up = input.parameters.name("up");
  Clip clip = read_clip(source, input.basis.skeleton, options);
  const int frame = input.parameters.integer("frame");
  if (frame < clip.first_frame || frame > clip.last_frame()) {
    input.parameters.refuse("is sculpted at frame ", frame, "; '", source, "' has frames ", clip.first_frame, " to ",
                            clip.last_frame());
  }
  Pose pose = clip.poses[static_cast<std::size_t>(frame - clip.first_frame)];
  pose.controls.clear();
  return pose;
}

// The joints named, or those that bend what was sculpted: skin on both sides of them belongs to it.
std::vector<std::uint32_t> listened_joints(const BakeInput& input, const Positions& delta) {
  const Skeleton& skeleton = input.basis.skeleton;
  std::vector<std::uint32_t> joints;
  if (input.parameters.has("joints")) {
    for (const Json& name : input.parameters.array("joints")) {
      const int joint = name.is_string() ? skeleton.find(name.get<std::string>()) : -1;
      if (joint < 0) input.parameters.refuse("names the joint ", name.dump(), ", which the skeleton does not have");
      joints.push_back(static_cast<std::uint32_t>(joint));
    }
    return joints;
  }
  const std::vector<double> shares = joint_shares_of(input.basis, delta.rowwise().norm());
  for (std::size_t j = 0; j < shares.size(); ++j) {
    const int parent = skeleton.joints[j].parent;
    if (parent >= 0 && shares[j] > kNoticed && shares[static_cast<std::size_t>(parent)] > kNoticed) {
      joints.push_back(static_cast<std::uint32_t>(j));
    }
  }
  if (joints.empty()) {  // within what one joint holds
    joints.push_back(static_cast<std::uint32_t>(std::ranges::max_element(shares) - shares.begin()));
  }
  return joints;
}

}  // namespace

// joints, numbers: see runtime/modifiers/drive_sculpt.cpp.
BakedModifier bake_sculpt(const BakeInput& input) {
  const Pose pose = sculpted_pose(input);
  const Positions target = unpose_ddm(input.basis, pose, read_modifier_shape(input, "mesh")),
                  own = unpose_ddm(input.basis, pose, EvaluatedSkin(without_modifiers(input.basis))({&pose, 1})[0]);
  BakedModifier baked;
  baked.components.push_back(target - own);
  baked.joints = listened_joints(input, baked.components[0]);
  baked.numbers.push_back(
      static_cast<float>(bake_number(input, "spread_degrees", 45, 1, 180) * std::numbers::pi / 180));
  for (const std::uint32_t joint : baked.joints) {
    for (const double x : pose.joints[joint].rotation) baked.numbers.push_back(static_cast<float>(x));
  }
  std::vector<std::string> names;
  for (const std::uint32_t joint : baked.joints) names.push_back(input.basis.skeleton.joints[joint].name);
  input.notes.push_back(input.place + " listens to " + list_names(names));
  return baked;
}

}  // namespace bodyopt::trainer
