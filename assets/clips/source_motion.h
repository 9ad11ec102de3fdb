// The skeleton of a clip's file and how it moves, as that of another is laid along it.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "assets/clips/joint_roles.h"
#include "runtime/core/transform.h"

namespace bodyopt {

struct SourceJoint {
  NamedJoint joint;
  JointTransform rest;      // relative to the parent, file units
  bool has_travel = false;  // its translation is animated, too
};

struct SourceMotion {
  std::string kind;                 // how notes call it: "BVH"
  bool in_world = false;            // its axes are the world's and it rests in a pose; else any, as `up` says
  std::string up;                   // its axis that is up: x, y, z, -x, -y, -z; empty: the motion tells
  std::vector<SourceJoint> joints;  // parents before children
  // Transforms of all joints, relative to their parents.
  std::function<std::vector<JointTransform>(double seconds)> locals_at;
};

// A bone of both skeletons: from the nearest matched joint above to a matched joint.
struct BonePair {
  std::size_t above, joint;                // of the skeleton
  std::size_t source_above, source_joint;  // of the source
  Vec3 skeleton, source;                   // in the bind pose, metres; at rest, file units; world
};

// World, per joint of the source.
struct SourceFrame {
  std::vector<Quat> rotation;
  std::vector<Affine> transform;

  Vec3 place(std::size_t joint) const { return transform[joint] * Vec3{0, 0, 0}; }
  Vec3 bone(const BonePair& pair) const { return place(pair.source_joint) - place(pair.source_above); }
};

SourceFrame source_frame(const SourceMotion& motion, const std::vector<JointTransform>& locals);

// Some frames, spread over all `frames` at `fps`, that tell what the motion is like.
std::vector<SourceFrame> sampled_frames(const SourceMotion& motion, std::size_t frames, double fps);

}  // namespace bodyopt
