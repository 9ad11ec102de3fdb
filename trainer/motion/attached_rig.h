// Rigs for inverse kinematics hang a foot under the root, where clips put it to the end of its leg. Motion made of
// turns would leave it behind: it is made on a rig in which every such joint hangs where its skin does.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "assets/characters/character.h"
#include "assets/clips/clip.h"
#include "trainer/motion/joint_limits.h"

namespace bodyopt::trainer {

// Joints whose skin goes on from the end of a limb (no skin hangs on joints below that), in joint order. It touches the
// skin of no joint they hang under, roots aside. Joints with half of the joints with skin or more below them are
// bodies, not feet. Those beside the limb's joint turn about the same parent. Neither is named.
std::vector<DetachedJoint> detached_joints(const Character& character);

// "by its skin 'LeftFoot' follows 'LeftLeg' ...", or empty.
std::string detached_text(const std::vector<DetachedJoint>& detached, const Skeleton& skeleton);

class AttachedRig {
 public:
  // Throws Error(mismatch) where a joint follows itself or one that hangs under it, or one whose scale would shear it.
  AttachedRig(const Skeleton& skeleton, const std::vector<DetachedJoint>& detached);

  // The character's skeleton, but that detached joints hang under those that they follow, in an order of its own.
  const Skeleton& skeleton() const { return attached_; }

  // The index in skeleton() of every own joint, and the other way round.
  const std::vector<std::uint32_t>& places() const { return place_; }
  const std::vector<std::uint32_t>& own_joints() const { return own_of_; }

  // Takes the character's own joints to those of skeleton().
  Character attached(Character character) const;
  JointLimits attached(JointLimits limits) const;  // without detached joints
  Pose attached(Pose pose) const;
  std::vector<Pose> attached(const std::vector<Pose>& poses) const;

  // Takes them back.
  JointLimits detached(JointLimits limits) const;
  Pose detached(Pose pose) const;
  Clip detached(Clip clip) const;

 private:
  Skeleton own_, attached_;
  std::vector<DetachedJoint> detached_;
  std::vector<std::uint32_t> place_, own_of_;
};

}  // namespace bodyopt::trainer
