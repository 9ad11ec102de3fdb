// The joints by which a basis was transferred from another body, and the clips of that body's joints.
#pragma once

#include <string>
#include <vector>

#include "assets/clips/clip.h"
#include "assets/clips/joint_match.h"
#include "runtime/basis/basis.h"

namespace bodyopt {

// The key of the metadata: a list of `from` of the source, `to` of the transferred basis.
constexpr const char* kMatchedJoints = "matched_joints";

// None where the basis was not transferred, or does not say.
std::vector<MappedJoint> matched_joints(const Metadata& metadata);

// Like read_clip(). A clip moves the basis by the source's names if it has all those by which the basis was
// transferred. It does not if it has all names of the basis' own joints, or the joint map names none but these. Names
// that the joint map gives to joints count as the clip's.
Clip read_clip(const std::string& source, const Basis& basis, const ClipOptions& options);

}  // namespace bodyopt
