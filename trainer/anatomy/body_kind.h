// The kind of animal that a body is: it decides where bones and cavities lie.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "assets/characters/character.h"
#include "runtime/basis/skeleton.h"

namespace bodyopt::trainer {

enum class BodyKind { biped, quadruped, bird, snake, fish, many_legs, limb };  // limb: an arm or leg alone
const char* name_of(BodyKind kind);
std::optional<BodyKind> body_kind_of(std::string_view name);
std::string body_kind_names();  // for messages: "biped, quadruped, ..."

struct RecognisedKind {
  BodyKind kind = BodyKind::biped;
  std::string why;  // for people: "four chains of joints reach the ground"
};
// The names of joints decide where they tell, otherwise the shape: limbs that end at the ground, wings, the trunk's
// length over its thickness.
RecognisedKind recognise_kind(const Character& character);

// J: does a bone lie between a joint and its parent? None lies from a root on the ground to the hips, to control
// joints, joint ends without skin, detached targets of inverse kinematics.
std::vector<bool> carries_bone(const Character& character);

// An artist's corrections of an anatomy: a small file beside the character, which changes nothing else.

struct AnatomyCorrections {
  struct OfBone {
    std::optional<bool> carries;  // do bones move with the joint? none: as found
    double thicker = 0;           // metres, on all sides of those
  };
  struct OfMuscle {
    double volume = 0;  // cubic metres of one side; 0: as the tables have it
    double factor = 1;  // of that
  };

  std::optional<BodyKind> kind;
  std::optional<double> body_fat;
  std::map<std::string, OfBone> bones;                  // by joint
  std::map<std::string, double> region_fat, joint_fat;  // factors of the fat's pattern, by BodyRegion's names, by joint
  std::map<std::string, OfMuscle> muscles;              // by name

  OfBone of_bone(const std::string& joint) const;
};

// anatomy.json. Throws Error(file) for bad bytes, Error(mismatch) for joints the skeleton lacks.
AnatomyCorrections read_corrections(const std::filesystem::path& path, const Skeleton& skeleton);

}  // namespace bodyopt::trainer
