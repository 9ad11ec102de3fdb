// A clip's channels to what the modifiers make of them: the weights of their components, and turned joints.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "runtime/basis/basis.h"
#include "runtime/basis/skeleton.h"

namespace bodyopt {

struct SkinModifierControl;

struct ModifierChannel {
  std::string name;
  const SkinModifierControl* control;
  float constant;  // where no clip gives the channel
};

// All channels that the modifiers of a basis know. Throw Error(mismatch) as drive_modifiers().
std::vector<ModifierChannel> describe_channels(const SkinModifiers& modifiers);
std::vector<std::string> modifier_channels(const SkinModifiers& modifiers);

// The state of a stack's modifiers after a frame: what the next one depends on beside its pose and channels.
struct ModifierState {
  std::vector<std::optional<double>> phases;  // of each modifier; none at a clip's first frame
};

// Applies the stack, in its order, to a clip's poses, which are consecutive frames. `channels`: names of the poses'
// controls; those that are none of the modifiers' are left alone. Fills Pose::modifiers, and turns joints, whose poses
// before stay in Pose::unmodified. Returns what was clamped, a sentence each. Throws Error(mismatch) for a modifier of
// a type that is not known, or tables that do not fit its type. `state`: that after the frame before, and then that
// after these: a clip in parts gets the bits of the whole. Null: the poses are the clip's first.
std::vector<std::string> drive_modifiers(const Basis& basis, std::span<const std::string> channels,
                                         double frames_per_second, std::span<Pose> poses,
                                         ModifierState* state = nullptr);

// Rotations of all joints of a pose, world.
std::vector<Quat> world_rotations(const Skeleton& skeleton, const Pose& pose);

}  // namespace bodyopt
