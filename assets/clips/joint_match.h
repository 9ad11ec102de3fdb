// Matches joints of a clip's file to the joints of a character that they move.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "assets/clips/joint_roles.h"
#include "runtime/basis/skeleton.h"

namespace bodyopt {

// Per joint of the skeleton: its joint among `source`, -1 for none; a joint of the source moves one joint. A joint map
// (a file, or empty) comes first. Then come equal names, unless they stand for different parts of the body, which is
// not asked where all names of the skeleton are there. Names equal but for case follow, then the same part of the body
// by other conventions (joint_roles()). Spines and necks of different lengths are laid along each other from end to
// end, unless one has all the names of the other. Notes name joints matched by case or convention. Messages say `whose`
// joints the source's are: "the clip a.glb". Throws Error(mismatch) where the map names joints that are not there, and
// as read_joint_map().
std::vector<int> match_joints(std::span<const NamedJoint> source, const Skeleton& skeleton,
                              const std::string& joint_map, const std::string& whose, std::vector<std::string>& notes);

// Parts of the body that a clip places each by itself, for it moves nothing that they hang on.
void note_parted(const Skeleton& skeleton, const std::vector<int>& match, std::vector<std::string>& notes);

// An entry of joint_map.json, which tells where names do not.
struct MappedJoint {
  std::string from, to;  // of the clip's file, of the character
};

// Each joint of either side once. Throws Error(file).
std::vector<MappedJoint> read_joint_map(const std::filesystem::path& path);

}  // namespace bodyopt
