#include "viewport/pin_joint.h"

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "runtime/core/error.h"
#include "shots/session/pinned_joints.h"

namespace bodyopt::viewport {
namespace {

// Returns the end of a joint's limb: for a finger the hand, as bones of fingers are short beside those of an arm.
std::string end_of_limb(const Skeleton& skeleton, const std::string& joint) {
  constexpr double kLong = 0.6;     // of the longest
  constexpr std::size_t kLimb = 5;  // joints from the one that is asked for upwards
  std::vector<std::size_t> ends;    // each with the two above it that reach
  std::vector<double> bones;        // metres
  for (std::string at = joint; ends.size() < kLimb && shots::ends_a_limb(skeleton, at);) {
    ends.push_back(static_cast<std::size_t>(skeleton.find(at)));
    const auto above = static_cast<std::size_t>(skeleton.joints[ends.back()].parent);
    bones.push_back(length(bind_place(skeleton, ends.back()) - bind_place(skeleton, above)));
    at = skeleton.joints[above].name;
  }
  const double longest = std::ranges::max(bones);
  const auto end = std::ranges::find_if(bones, [&](double bone) { return bone >= kLong * longest; }) - bones.begin();
  return skeleton.joints[ends[static_cast<std::size_t>(end)]].name;
}

// Names what could be pinned: joints at the ends, the first ten.
std::string joints_with_two_above(const Skeleton& skeleton) {
  constexpr int kNamed = 10;
  std::set<std::string> ends;
  for (const Joint& joint : skeleton.joints) {
    if (shots::ends_a_limb(skeleton, joint.name)) ends.insert(end_of_limb(skeleton, joint.name));
  }
  std::string names;
  int named = 0;
  for (const std::string& end : ends) {
    if (named++ < kNamed) names += (names.empty() ? "these have: " : ", ") + end;
  }
  return names.empty() ? "none of this character has" : names;
}

}  // namespace

void pin_joint(const PinRequest& request, const Scene& scene, Controls& controls) {
  const Skeleton& skeleton = scene.lead().basis().skeleton;
  if (!shots::ends_a_limb(skeleton, request.joint)) {
    throw Error(ErrorKind::usage, request.joint + ": has no two joints above it that could reach for a pin; " +
                                      joints_with_two_above(skeleton));
  }
  if (request.at) {
    controls.settings.pose.pins[request.joint] = *request.at;
    return;
  }
  const auto asked = static_cast<std::size_t>(skeleton.find(request.joint));
  const bool is_end = shots::ends_a_foot(skeleton, asked) || shots::is_on_spine(skeleton, asked);
  const std::string end = is_end ? request.joint : end_of_limb(skeleton, request.joint);
  if (end != request.joint) {
    controls.say(end + " is pinned, the end of the limb that " + request.joint + " is of; a point pins any joint");
    controls.select(end);
  }
  const auto joint = static_cast<std::size_t>(skeleton.find(end));
  shots::ViewSettings::Posing& pose = controls.settings.pose;
  const Vec3 facing = scene.lead().facing(joint, controls.playback.frame(), pose);
  pose.pins[end] = scene.joint_centres(controls)[joint];
  pose.facing[end] = facing;
}

}  // namespace bodyopt::viewport
