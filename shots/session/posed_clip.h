// Poses that an animator set on top of a clip, or of the bind pose, before modifiers.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "assets/clips/clip.h"
#include "runtime/basis/basis.h"
#include "runtime/modifiers/drive_modifiers.h"
#include "shots/session/between_keys.h"
#include "shots/session/pinned_joints.h"
#include "shots/session/view_settings.h"

namespace bodyopt::shots {

// How far joints may turn.
struct Turning {
  trainer::JointLimits limits{};
  std::vector<std::optional<JointRange>> ranges{};  // of every joint; or empty: as far as they are turned
};
Turning turning_within(trainer::JointLimits limits, const Skeleton& skeleton);

// Blends two poses, `t` from 0 to 1. Joints, axes and moves that one leaves out are there as the clip has them,
// controls and pins as the other has them.
ViewSettings::PoseKey blended(const ViewSettings::PoseKey& a, const ViewSettings::PoseKey& b, double t);

// The pose between two keys, by the eases of the first: see between_keys().
ViewSettings::PoseKey eased_between(const KeySpan<ViewSettings::PoseKey>& span);

// Returns the posing at a frame: by its keys, or, without any, as it is.
ViewSettings::Posing keyed_posing(ViewSettings::Posing posing, int frame);

// Makes a clip where there is none to pose: the bind pose for ten seconds.
Clip still_clip(const Skeleton& skeleton, const ClipOptions& options);

// Returns what may be added to a clip's pose along a degree of freedom, degrees. Its sum with the clip's own turn keeps
// the limits; zero always may. Of several joints the clip's turn is the mean.
std::pair<double, double> free_angles(const trainer::JointLimits& limits, const Skeleton& skeleton,
                                      const trainer::DegreeOfFreedom& dof, const Pose& clip);

// Turns joints about the axes of the limits, then by their own angles, as far as their ranges let them, and moves them.
// Then limbs reach for where their ends are pinned.
Pose posed(const Skeleton& skeleton, const Turning& turning, const Pose& clip, const ViewSettings::PoseKey& posing);
// Pins that it does not reach.
std::vector<MissedPin> missed_pins(const Skeleton& skeleton, const Turning& turning, const Pose& clip,
                                   const ViewSettings::PoseKey& posing);

// Returns a PoseKey::facing by which a joint keeps its present orientation once it is pinned.
Vec3 facing_of(const Skeleton& skeleton, const Turning& turning, const Pose& clip, const ViewSettings::PoseKey& posing,
               std::size_t joint);

// The states of a basis' modifiers before frames of a clip, kept while what steers them is the same.
class ModifierTrack {
 public:
  // Before frame number `at`. `controls`: as posed_frame() names them; the clip is always the same one.
  ModifierState before(std::size_t at, const Clip& clip, const std::vector<std::string>& controls, const Basis& basis,
                       const ViewSettings::Posing& posing);

 private:
  const Basis* basis_ = nullptr;
  std::vector<std::string> controls_;
  std::map<int, ViewSettings::PoseKey> keys_;             // controls alone
  std::map<std::size_t, ModifierState> before_{{0, {}}};  // by number
};

// The pose number `at` of what posed_clip() and then apply_channels() make of the clip, to the last bit. `track`: of
// this clip.
Pose posed_frame(const Clip& clip, std::size_t at, const Basis& basis, const Turning& turning,
                 const ViewSettings::Posing& posing, ModifierTrack& track);

// Poses the whole clip, frame by frame as its keys say. Its controls are those that it has, or the posing sets at any
// frame.
Clip posed_clip(Clip clip, const Skeleton& skeleton, const Turning& turning, const ViewSettings::Posing& posing);

}  // namespace bodyopt::shots
