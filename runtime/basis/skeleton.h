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

// The nine features of a joint are R - I, row-major.
//   R = above_turn (rotation of `joint` relative to `above`, away from the bind pose, in rest axes) own_turn^-1.
// A sliding joint has six zeros after
//   per_metre above_turn (place of `joint` relative to `above`, less that of the bind pose, in rest axes, metres).
// They let a basis that was transferred from another skeleton read the features of that one.
struct JointFeatures {
  // Both are of one tree: a joint and its parent, or the joint from which a detached foot goes on. The same joint
  // twice: it does not move here.
  std::uint32_t joint = 0, above = 0;
  Quat above_turn{0, 0, 0, 1}, own_turn{0, 0, 0, 1};
  double per_metre = 0;  // 0: of a rotation

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

  // The joints that learned corrections go by: they know nothing of modifiers.
  const std::vector<JointTransform>& own_joints() const { return unmodified.empty() ? joints : unmodified; }
};

// The nearest common ancestor, or one of the two where it is above the other; -1 under different roots.
int common_joint(const Skeleton& skeleton, std::uint32_t one, std::uint32_t other);

Pose bind_pose(const Skeleton& skeleton);

// The place of a joint in the bind pose: rest space, metres.
Vec3 bind_place(const Skeleton& skeleton, std::size_t joint);

}  // namespace bodyopt
