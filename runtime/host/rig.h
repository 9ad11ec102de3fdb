// The rig stage: forward kinematics on the host, in double precision, batched by the caller.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "runtime/basis/skeleton.h"

namespace bodyopt {

// The parts of one posed frame that the other stages need.
struct RigFrame {
  // J x 12: skinning matrices (posed joint matrix times inverse bind matrix), three rows of four, relative to origin.
  std::vector<float> skinning;
  // Posed position of the first root joint, metres, world. The matrices lose it before they are rounded to single
  // precision, and the pose stage adds it back. So the skin is as exact at 100 m as at the origin.
  float origin[3];
  std::vector<double> joints;  // J x 3: posed positions of the joints, metres, world
  // 9 values for each of joint_features_of(skeleton), of the pose before modifiers turned joints (Pose::own_joints).
  // For most characters they are R_k - I, row-major. R_k is a joint's rotation relative to its parent, away from the
  // bind pose, in rest axes. They are made of local transforms only: a turn of the root changes no bit.
  std::vector<float> joint_features;
  std::vector<float> learned_skinning;  // as skinning, of that pose: for the strains
  std::vector<Affine> world;            // scratch
};

// Posed joint matrices (joint space to world), J, in double precision. world: memory that is used again.
std::vector<Affine> posed_joints(const Skeleton& skeleton, std::span<const JointTransform> local,
                                 std::vector<Affine> world = {});

// Skinning matrices (rest space to world), J, in double precision.
std::vector<Affine> skinning_matrices(const Skeleton& skeleton, std::span<const JointTransform> local);

// The local transform of joint j that has this skinning matrix below its parent's (any, below none). Throws
// Error(mismatch) where it has none: a number is not finite, a scale is 0, or it is sheared against its parent.
JointTransform local_joint(const Skeleton& skeleton, std::size_t j, const Affine& skinning, const Affine& of_parent);

// Rotation of each joint in the bind pose, world; scale and shear are left out.
std::vector<Quat> bind_rotations(const Skeleton& skeleton);

// A skeleton, which must outlive it, with what all frames need of it.
class Rig {
 public:
  explicit Rig(const Skeleton& skeleton);
  // Into the memory of an earlier frame. Throws Error(mismatch) when the pose has another number of joints than the
  // skeleton, when it is not finite, and when a rotation has no length.
  void pose(const Pose& pose, RigFrame& frame) const;
  const std::vector<JointFeatures>& features() const { return features_; }

 private:
  void find_features(const std::vector<JointTransform>& joints, std::vector<float>& features) const;

  const Skeleton& skeleton_;
  const std::vector<JointFeatures> features_;  // joint_features_of
  const std::vector<Quat> bind_;               // bind_rotations
};

// Poses the rig for one frame. Throws as Rig::pose.
RigFrame pose_rig(const Skeleton& skeleton, const Pose& pose);

// skeleton.features, or, where there are none, those of every joint but roots, in joint order.
std::vector<JointFeatures> joint_features_of(const Skeleton& skeleton);

std::uint32_t joint_feature_count(const Skeleton& skeleton);  // 9 for each of these

// Joint index of each group of nine joint features.
std::vector<std::uint32_t> feature_joints(const Skeleton& skeleton);

}  // namespace bodyopt
