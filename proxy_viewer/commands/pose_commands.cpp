// Playback: what is shown when.
#include <algorithm>
#include <tuple>

#include "assets/joint_roles.h"
#include "proxy_viewer/commands/commands.h"
#include "runtime/core/error.h"
#include "shots/session/pinned_joints.h"

namespace bodyopt {
namespace {

// "12", or as the take of a dataset that is open numbers it: "rom 40".
int frame_of_clip(const Controls& controls, const std::string& text) {
  if (text.find(' ') != std::string::npos) {
    const std::vector<std::string>& frames = controls.curating.frames;
    const auto place = std::ranges::find(frames, known(text, frames, "frame of a dataset's take")) - frames.begin();
    return controls.playback.first() + static_cast<int>(place);
  }
  const int frame = integer(text);
  controls.playback.require_frame(frame);
  return frame;
}

void require_keys(const Playback& playback) {
  if (!playback.keys().empty()) return;
  throw Error(ErrorKind::usage,
              "the clip has no keys to go to: a BVH samples its motion, and so does a clip with a key at most frames");
}

const Command kPlaybackCommands[] = {
    {"play", "", "Space", "Playback", "play or pause",
     [](Playback& playback, const std::string&) { playback.toggle(); },
     [](const Controls& c) { return name_of(c.playback.playing()); }},
    {"step", "[FRAMES]", "Right", "Playback", "one frame on",
     [](Playback& playback, const std::string& a) { playback.step(a.empty() ? 1 : integer(a)); }, nullptr, kRepeats},
    {"step-back", "", "Left", "Playback", "one frame back",
     [](Playback& playback, const std::string&) { playback.step(-1); }, nullptr, kRepeats},
    {"first", "", "Home", "Playback", "to the first frame of the range",
     [](Playback& playback, const std::string&) { playback.scrub(playback.in()); }},
    {"last", "", "End", "Playback", "to the last frame of the range",
     [](Playback& playback, const std::string&) { playback.scrub(playback.out()); }},
    {"next-key", "", "Up", "Playback", "to the next key",
     [](Playback& playback, const std::string&) {
       require_keys(playback);
       playback.go_to_next_key();
     },
     nullptr, kRepeats},
    {"previous-key", "", "Down", "Playback", "to the key before",
     [](Playback& playback, const std::string&) {
       require_keys(playback);
       playback.go_to_previous_key();
     },
     nullptr, kRepeats},
    {"frame", "FRAME", "", "Playback", "to a frame; of a dataset's take: rom 40",
     [](Controls& c, const std::string& a) { c.playback.scrub(frame_of_clip(c, a)); }},
    {"backwards", "[on|off]", "B", "Playback", "play backwards",
     [](Playback& playback, const std::string& a) {
       bool backwards = playback.backwards();  // as it goes now, in ping-pong
       toggle(backwards, a);
       playback.set_backwards(backwards);
     },
     [](const Controls& c) { return name_of(c.playback.backwards()); }},
    {"mode", "loop|ping-pong|once", "", "Playback", "what happens at the end of the range",
     [](Playback& playback, const std::string& a) {
       PlayMode mode = playback.mode();
       choose(mode, a, kPlayModeNames);
       playback.set_mode(mode);
     },
     [](const Controls& c) { return name_of(c.playback.mode(), kPlayModeNames); }},
    {"speed", "0.1-2", "", "Playback", "of playing; 1: as it is",
     [](Playback& playback, const std::string& a) {
       const double speed = number_within(a, PlaySettings::kSlowest, PlaySettings::kFastest);
       playback.set_speed(speed);
     }},
    {"every-frame", "[on|off]", "", "Playback", "drop no frame, however long it takes",
     [](Playback& playback, const std::string& a) {
       bool every = !playback.real_time();
       toggle(every, a);
       playback.set_real_time(!every);
     },
     [](const Controls& c) { return name_of(!c.playback.real_time()); }},
    {"in", "[FRAME]", "I", "Playback", "the range begins here",
     [](Controls& c, const std::string& a) {
       const int in = a.empty() ? c.playback.frame() : frame_of_clip(c, a);
       if (in > c.playback.out()) c.say("the range ended earlier: it is this frame now");
       c.playback.set_range(in, std::max(in, c.playback.out()));
     }},
    {"out", "[FRAME]", "O", "Playback", "the range ends here",
     [](Controls& c, const std::string& a) {
       const int out = a.empty() ? c.playback.frame() : frame_of_clip(c, a);
       if (out < c.playback.in()) c.say("the range began later: it is this frame now");
       c.playback.set_range(std::min(c.playback.in(), out), out);
     }},
    {"whole-range", "", "Alt+I", "Playback", "play all frames",
     [](Playback& playback, const std::string&) { playback.set_range(playback.first(), playback.last()); }},
    {"live", "[on|off]", "", "Playback", "poses that another program sends, or the clip",
     [](Controls& c, const std::string& a) {
       if (!c.live) throw Error(ErrorKind::usage, "no poses are listened for: begin with --live PORT");
       toggle(*c.live, a);
     },
     [](const Controls& c) { return name_of(c.live.value_or(false)); }},
};

// Posing, and keys.

// The joint that is named, or is selected where none is.
std::string named_or_selected(const Controls& controls, const std::string& name) {
  if (!name.empty()) return known(name, controls.joint_names, "joint");
  if (controls.joint.empty()) throw Error(ErrorKind::usage, "no joint is selected, nor was one named");
  return controls.joint;
}

// Of the bind pose, joint to world; `joint` is one of joint_names.
const Quat& axes_of(const Controls& controls, const std::string& joint) {
  const auto at = std::ranges::find(controls.joint_names, joint);
  return controls.joint_axes.at(static_cast<std::size_t>(at - controls.joint_names.begin()));
}

const Command kPoseCommands[] = {
    {"select", "[JOINT]", "", "Pose", "a joint; nothing: none",
     [](Controls& c, const std::string& a) { c.joint = a.empty() ? a : known(a, c.joint_names, "joint"); }},
    {"turn", "JOINT X Y Z", "", "Pose", "a joint on top of the clip, degrees",
     [](Controls& c, const std::string& a) {
       std::string joint = a, angle;
       Vec3 angles;
       for (const std::size_t axis : {2, 1, 0}) {
         std::tie(joint, angle) = split_last(joint, "a joint and three angles in degrees");
         angles[axis] = number_within(angle, -kMostTurn, kMostTurn);
       }
       c.settings.pose.joints[known(joint, c.joint_names, "joint")] = angles;
     }},
    {"axis", "NAME DEGREES", "", "Pose", "a joint along an axis of its limits, on top of the clip",
     [](Controls& c, const std::string& a) {
       const auto [name, angle] = split_last(a, "an axis and an angle in degrees");
       c.settings.pose.axes[known(name, c.axis_names, "axis of the joint limits")] =
           number_within(angle, -kMostTurn, kMostTurn);
     }},
    {"pin", "JOINT [X Y Z]", "", "Pose",
     "the end of a limb where it is, or a joint there, metres: the limb reaches for it",
     [](Controls& c, const std::string& a) {
       if (std::ranges::find(c.joint_names, a) != c.joint_names.end()) {
         c.requests.pin = PinRequest{a};
         return;
       }
       std::string joint = a, number;
       Vec3 at;
       for (const std::size_t axis : {2, 1, 0}) {
         std::tie(joint, number) = split_last(joint, "a joint, or a joint and a point");
         at[axis] = number_within(number, -1e6, 1e6);
       }
       c.requests.pin = PinRequest{known(joint, c.joint_names, "joint"), at};
     }},
    {"unpin", "[JOINT]", "", "Pose", "lets go of the joint that is selected",
     [](Controls& c, const std::string& a) {
       const std::string joint = named_or_selected(c, a);
       if (c.settings.pose.pins.erase(joint) == 0) c.say(joint + " has no pin");
     }},
    {"move-key", "FROM TO", "", "Pose", "the key of a frame to another",
     [](Controls& c, const std::string& a) {
       const auto w = words(a, 2, "two frames");
       const int from = integer(w[0]), to = integer(w[1]);
       c.playback.require_frame(to);
       const auto key = c.settings.pose.keys.find(from);
       if (key == c.settings.pose.keys.end()) refuse(w[0], "a frame that has a key");
       if (from == to) return;
       c.settings.pose.keys[to] = key->second;
       c.settings.pose.keys.erase(from);
       c.keyed_frame.reset();
     }},
    {"key", "", "Alt+K", "Pose", "keeps turns and controls as a key of this frame; between keys they blend",
     [](Controls& c, const std::string&) {
       c.settings.pose.keys[c.playback.frame()] = c.settings.pose;
       c.keyed_frame = c.playback.frame();
     }},
    {"unkey", "", "", "Pose", "forgets the key of this frame",
     [](Controls& c, const std::string&) {
       const int frame = c.playback.frame();
       if (c.settings.pose.keys.erase(frame) == 0) c.say("frame " + std::to_string(frame) + " has no key");
       c.keyed_frame.reset();
     }},
    {"mirror", "[JOINT]", "P", "Pose", "turns the other side's joint as the one that is selected",
     [](Controls& c, const std::string& a) {
       const std::string joint = named_or_selected(c, a);
       const std::string other = mirrored_name(joint, c.joint_names);
       if (other.empty()) refuse(joint, "a joint that another side has, too");
       const Vec3 angles = set_or(c.settings.pose.joints, joint, {});
       c.settings.pose.joints[other] = mirrored_angles(angles, axes_of(c, joint), axes_of(c, other));
     }},
    {"reset-joint", "[JOINT]", "Shift+R", "Pose", "the joint that is selected as the clip has it",
     [](Controls& c, const std::string& a) { c.settings.pose.joints.erase(named_or_selected(c, a)); }},
    {"control", "NAME VALUE", "", "Pose", "a control of the basis, as a muscle's activation",
     [](Controls& c, const std::string& a) {
       const auto [name, value] = split_last(a, "a control and a number");
       c.settings.pose.controls[known(name, c.control_names, "control of the basis")] =
           number_within(value, -kMostControl, kMostControl);
     }},
    {"reset-pose", "", "R", "Pose", "the pose as the clip has it",
     [](ViewSettings::Posing& pose, const std::string&) { static_cast<ViewSettings::PoseKey&>(pose) = {}; }},
    {"undo", "", "Ctrl+Z", "Pose", "turns, controls and keys before the last change; with a brush in hand: undo-edit",
     [](Controls& c, const std::string&) {
       if (c.brush.kind) {
         c.requests.step_back = true;
         return;
       }
       if (!c.poses.undo(c.settings.pose)) c.say("nothing to undo: only turns, controls and keys are");
     }},
    {"redo", "", "Ctrl+Shift+Z", "Pose", "turns, controls and keys that were undone; with a brush in hand: redo-edit",
     [](Controls& c, const std::string&) {
       if (c.brush.kind) {
         c.requests.step_back = false;
         return;
       }
       if (!c.poses.redo(c.settings.pose)) c.say("nothing to redo");
     }},
    {"correction", "0-1", "", "Pose", "how much is shown of what was learned",
     [](ViewSettings::Posing& pose, const std::string& a) { pose.correction = number_within(a, 0, 1); }},
    switch_command<&ViewSettings::Jiggling::on>("jiggle", "J", "Pose", "flesh that moves by inertia"),
    {"jiggle-amount", "0-4", "", "Pose", "how much is shown of the jiggle",
     [](ViewSettings::Jiggling& jiggle, const std::string& a) { jiggle.amount = number_within(a, 0, kMostJiggle); }},
    request_command<&Requests::reset_jiggle>("reset-jiggle", "", "Pose", "the jiggle begins anew"),
};

}  // namespace

std::span<const Command> playback_commands() { return kPlaybackCommands; }

std::span<const Command> pose_commands() { return kPoseCommands; }

}  // namespace bodyopt
