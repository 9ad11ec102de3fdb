// The joints of a character. Parents come before children.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "runtime/core/transform.h"

namespace bodyopt {

struct Joint {
  std::string name;
  int parent = -1;               // index of the parent joint, -1 for a root
  JointTransform bind;           // local transform in the bind (rest) pose, relative to the parent joint
  JointTransform default_local;  // local transform where a clip does not animate the joint (the file's node transform)
  Affine inverse_bind;           // rest space (mesh space, metres) to joint space
};

// What nine joint features tell: R - I, row-major, of
//   R = above_turn (rotation of `joint` relative to `above`, away from the bind pose, in rest axes) own_turn^-1.
// A basis that was carried from another skeleton so reads the features of that one.
struct JointFeatures {
  std::uint32_t joint = 0, above = 0;  // `above` is above it; or the same, of a joint that does not turn here
  Quat above_turn{0, 0, 0, 1}, own_turn{0, 0, 0, 1};

  bool operator==(const JointFeatures&) const = default;
};

struct Skeleton {
  std::vector<Joint> joints;
  std::vector<JointFeatures> features{};  // empty: of every joint but roots, relative to its parent, as it is

  std::size_t size() const { return joints.size(); }
  int find(const std::string& name) const;  // index, or -1
};

// xxh3 of names, parents and bind matrices (rounded to 1e-5 m so that a re-export matches).
std::uint64_t skeleton_hash(const Skeleton& skeleton);

// One frame of a rig: a local transform per joint, and one value per named control (activation, breath).
struct Pose {
  std::vector<JointTransform> joints;
  std::vector<float> controls;
  std::vector<float> modifiers{};            // weights of the modifiers' components (drive_modifiers); empty: all 0
  std::vector<JointTransform> unmodified{};  // joints before modifiers turned some; empty: none did

  // Those that what was learned goes by: it knows nothing of modifiers.
  const std::vector<JointTransform>& own_joints() const { return unmodified.empty() ? joints : unmodified; }
};

Pose bind_pose(const Skeleton& skeleton);

// Where a joint stands in the bind pose: rest space, metres.
Vec3 bind_place(const Skeleton& skeleton, std::size_t joint);

}  // namespace bodyopt
