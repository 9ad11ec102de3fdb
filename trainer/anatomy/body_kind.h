// What kind of animal a body is: it decides where bones and cavities lie.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "assets/character.h"

namespace bodyopt {

enum class BodyKind { biped, quadruped, bird, snake, fish, many_legs, limb };  // limb: an arm or leg alone
const char* name_of(BodyKind kind);
std::optional<BodyKind> body_kind_of(std::string_view name);
std::string body_kind_names();  // for messages: "biped, quadruped, ..."

struct RecognisedKind {
  BodyKind kind = BodyKind::biped;
  std::string why;  // for people: "four chains of joints reach the ground"
};
// By the names of joints where they tell, otherwise by the shape: chains of joints that end at the ground, wings, how
// much longer than thick the trunk is.
RecognisedKind recognise_kind(const Character& character);

// J: does a bone lie between a joint and its parent? Not from a root on the ground to the hips, nor to control joints,
// joint ends without skin, detached targets of inverse kinematics.
std::vector<bool> carries_bone(const Character& character);

}  // namespace bodyopt
