// Which part of a body a joint is, told from the names that rigs and motion capture commonly give.
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

// The words of a joint's name in small letters, without what stands before the names of all joints alike:
// "LeftHandIndex1" and "left_hand.index-1" are left, hand, index, 1; "LThumb" is l, thumb.
std::vector<std::string> name_words(std::string_view name);

// By a word of the name, whatever else it says; middle where none tells.
BodySide side_of_name(std::string_view name);

std::vector<NamedJoint> named_joints(const Skeleton& skeleton);

// The names of CMU's motion capture (as 3ds Max, MotionBuilder, Poser and Daz have them), Mixamo, HumanIK and Unreal,
// also behind words that most names begin with, whatever they are ("Bip01 L Thigh").
// What a name means may depend on the others: "LeftShoulder" is the upper arm beside a "LeftCollar", the clavicle
// beside a "LeftArm". Nothing for other names, and for a second joint of the same role.
std::vector<std::optional<JointRole>> joint_roles(std::span<const NamedJoint> joints);

// The name of what is on the other side of a body: "RightArm" for "LeftArm", also left and LEFT; a letter that stands
// alone, as in "L_Arm", "arm_l", "Bip01 L Arm", "arm.L"; or one at the end of a word with capitals, "LThumb", "ThumbL".
// Empty where `names` has no such name.
std::string mirrored_name(const std::string& name, std::span<const std::string> names);
// Of every name the place of that of the other side; -1 where there is none.
std::vector<int> mirrored_places(std::span<const std::string> names);

}  // namespace bodyopt
