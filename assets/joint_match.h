// Matches joints of a clip's file to the joints of a character that they move.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "assets/clip.h"
#include "assets/joint_roles.h"
#include "runtime/basis/basis.h"
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

// The joints by which a basis was transferred from another body, and the clips of that body's joints.

// The key of the metadata: a list of `from` of the source, `to` of the transferred basis.
constexpr const char* kMatchedJoints = "matched_joints";

// None where the basis was not transferred, or does not say.
std::vector<MappedJoint> matched_joints(const Metadata& metadata);

// Like read_clip(). A clip moves the basis by the source's names if it has all those by which the basis was
// transferred. It does not if it has all names of the basis' own joints, or the joint map names none but these. Names
// that the joint map gives to joints count as the clip's.
Clip read_clip(const std::string& source, const Basis& basis, const ClipOptions& options);

}  // namespace bodyopt
