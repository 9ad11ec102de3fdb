// Parts of a body that joints are, by the names that rigs and motion capture commonly give.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "runtime/basis/skeleton.h"

namespace bodyopt {

enum class BodyPart : std::uint8_t {
  hips,
  spine,
  neck,
  head,  // of the middle
  hip_joint,
  thigh,
  shin,
  foot,
  toe,  // of either side
  clavicle,
  upper_arm,
  forearm,
  hand,
  palm,  // palm: a joint between the hand's and the fingers'
  thumb,
  index,
  middle,
  ring,
  pinky  // index: also all fingers where they are one joint
};

enum class BodySide : std::uint8_t { middle, left, right };

struct JointRole {
  BodyPart part;
  BodySide side;
  std::size_t nested = 0;  // how many joints above are of the same part: of spines, necks and fingers

  bool operator==(const JointRole&) const = default;
};

// A joint of a character or of a clip's file.
struct NamedJoint {
  std::string name;
  int parent = -1;  // index, -1 for none; parents come before children
};

// The words of a joint's name in small letters, without prefixes of all joints' names. So "LeftHandIndex1" and
// "left_hand.index-1" are left, hand, index, 1; "LThumb" is l, thumb.
std::vector<std::string> name_words(std::string_view name);

// A word of the name tells the side, whatever else it says; middle where none tells.
BodySide side_of_name(std::string_view name);

std::vector<NamedJoint> named_joints(const Skeleton& skeleton);

// Knows names of CMU's motion capture (as 3ds Max, MotionBuilder, Poser and Daz have them), Mixamo, HumanIK and Unreal.
// Words that most names begin with, as in "Bip01 L Thigh", do not matter. A name's meaning may depend on the others:
// "LeftShoulder" is the upper arm beside a "LeftCollar", the clavicle beside a "LeftArm". Nothing for other names, and
// for a second joint of the same role.
std::vector<std::optional<JointRole>> joint_roles(std::span<const NamedJoint> joints);

// The name of the counterpart on the other side of a body: "RightArm" for "LeftArm", also left and LEFT. A letter may
// stand alone, as in "L_Arm", "arm_l", "Bip01 L Arm", "arm.L". It may also be at the end of a word with capitals,
// "LThumb", "ThumbL". Empty where `names` has no such name.
std::string mirrored_name(const std::string& name, std::span<const std::string> names);
// The place of every name's counterpart on the other side; -1 where there is none.
std::vector<int> mirrored_places(std::span<const std::string> names);

}  // namespace bodyopt
