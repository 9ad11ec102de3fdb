// What an animator set on top of a clip, or of the bind pose, as poses before modifiers.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "assets/clip.h"
#include "runtime/basis/basis.h"
#include "shots/session/pinned_joints.h"
#include "shots/session/view_settings.h"

namespace bodyopt {

// What is set on top of the clip, between the frames that have keys.
// Slow at each key, fast between them; before the first and after the last as those. Joints and axes that a key leaves
// out are there as the clip has them, controls and pins as the other key has them. There must be a key.
ViewSettings::PoseKey between_keys(const std::map<int, ViewSettings::PoseKey>& keys, int frame);

// The posing as it is at a frame: by its keys, or, without any, as it is.
ViewSettings::Posing keyed_posing(ViewSettings::Posing posing, int frame);

// Where there is no clip to pose: the bind pose for ten seconds.
Clip still_clip(const Skeleton& skeleton, const ClipOptions& options);

// Joints of the pose turned about the axes of the limits, then by their own angles, as far as their ranges let them;
// then limbs reach for where their ends are pinned. `ranges`: of every joint, or empty: as far as they are turned.
Pose posed(const Skeleton& skeleton, const JointLimits& limits, const std::vector<std::optional<JointRange>>& ranges,
           Pose pose, const ViewSettings::PoseKey& posing);

// The pose number `at` of what posed_clip() and then apply_channels() make of the clip, to the last bit. `ranges`: of
// every joint, as posed() takes them.
Pose posed_frame(const Clip& clip, std::size_t at, const Basis& basis, const JointLimits& limits,
                 const std::vector<std::optional<JointRange>>& ranges, const ViewSettings::Posing& posing);

// The whole clip so, frame by frame as its keys say. Its controls are those that it has, or the posing sets at any
// frame.
Clip posed_clip(Clip clip, const Skeleton& skeleton, const JointLimits& limits, const ViewSettings::Posing& posing);

}  // namespace bodyopt
