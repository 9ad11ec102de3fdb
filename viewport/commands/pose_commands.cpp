// Playback: what is shown when.
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <tuple>

#include "assets/clips/joint_roles.h"
#include "runtime/core/error.h"
#include "shots/session/posed_clip.h"
#include "shots/session/setting_fields.h"
#include "viewport/commands/commands.h"
#include "viewport/commands/flipped_pose.h"

namespace bodyopt::viewport {
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

// Returns those of the clip, of the poses and of the camera that lie in the clip.
std::set<int> require_keys(const Controls& controls) {
  const Playback& playback = controls.playback;
  const std::vector<int> of_clip = playback.keys();
  std::set<int> keys(of_clip.begin(), of_clip.end());
  const auto add = [&](int frame) {
    if (playback.first() <= frame && frame <= playback.last()) keys.insert(frame);
  };
  for (const auto& [frame, key] : controls.settings.pose.keys) add(frame);
  for (const auto& [frame, key] : controls.settings.shot_camera.keys) add(frame);
  if (!keys.empty()) return keys;
  throw Error(
      ErrorKind::usage,
      "there are no keys to go to, none was set, and the clip has none: a BVH samples its motion, and so does a "
      "clip with a key at most frames");
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
     [](Controls& c, const std::string&) { c.playback.go_to_next_key(require_keys(c)); }, nullptr, kRepeats},
    {"previous-key", "", "Down", "Playback", "to the key before",
     [](Controls& c, const std::string&) { c.playback.go_to_previous_key(require_keys(c)); }, nullptr, kRepeats},
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
       shots::PlayMode mode = playback.mode();
       choose(mode, a, shots::kPlayModeNames);
       playback.set_mode(mode);
     },
     [](const Controls& c) { return name_of(c.playback.mode(), shots::kPlayModeNames); }},
    {"speed", "0.1-2", "", "Playback", "of playing; 1: as it is",
     [](Playback& playback, const std::string& a) {
       const double speed = number_within(a, shots::PlaySettings::kSlowest, shots::PlaySettings::kFastest);
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
    switch_command<&Controls::zooms>("zoom-range", "Shift+I", "Playback", "the timeline shows only the range"),
    {"whole-range", "", "Alt+I", "Playback", "play all frames",
     [](Playback& playback, const std::string&) { playback.set_range(playback.first(), playback.last()); }},
    {"sound", "[FILE.wav|none] [FRAME]", "", "Playback", "its waveform under the timeline, from a frame on",
     [](Controls& c, const std::string& a) {
       if (a.empty()) return c.browse("sound");
       c.requests.sound = shots::SoundFile{a == "none" ? "" : a, c.playback.first()};
       if (a == "none" || a.ends_with(".wav")) return;
       const auto [file, frame] = split_last(a, "a file that ends in .wav, and the frame that it begins at");
       require_ending(file, ".wav");
       c.requests.sound = shots::SoundFile{file, integer_within(frame, -shots::kLatestFrame, shots::kLatestFrame)};
     }},
    {"live", "[on|off]", "", "Playback", "poses that another program sends, or the clip",
     [](Controls& c, const std::string& a) {
       if (!c.live) throw Error(ErrorKind::usage, "no poses are listened for: begin with --live PORT");
       toggle(*c.live, a);
     },
     [](const Controls& c) { return name_of(c.live.value_or(false)); }},
};

// Posing, and keys.

// Returns the joint that is named, or the selected one.
std::string named_or_selected(const Controls& controls, const std::string& name) {
  if (!name.empty()) return known(name, controls.joint_names, "joint");
  if (controls.joint.empty()) throw Error(ErrorKind::usage, "no joint is selected, nor was one named");
  return controls.joint;
}

// "LeftArm 0 0 20": the numbers are the last three words.
std::pair<std::string, Vec3> joint_and_three(const std::string& text, const std::string& expected, double most) {
  std::string joint = text, number;
  Vec3 three;
  for (const std::size_t axis : {2, 1, 0}) {
    std::tie(joint, number) = split_last(joint, expected);
    three[axis] = number_within(number, -most, most);
  }
  return {joint, three};
}

// Moves the keys of the range; keys that give way are reported. Throws Error(usage) where the range has no keys, or the
// clip has no such frame.
void move_keys(Controls& c, bool takes_away, const std::function<int(int)>& to) {
  std::map<int, shots::ViewSettings::PoseKey> moved, kept;
  std::size_t count = 0;
  for (const auto& [frame, key] : c.settings.pose.keys) {
    const bool is_within = c.playback.in() <= frame && frame <= c.playback.out();
    if (!is_within || !takes_away) kept[frame] = key;
    if (!is_within) continue;
    c.playback.require_frame(to(frame));
    ++count;
    moved[to(frame)] = key;
  }
  if (moved.empty()) throw Error(ErrorKind::usage, "the range has no keys");
  count += kept.size();
  moved.merge(kept);
  if (count > moved.size())
    c.say(std::to_string(count - moved.size()) + " of the keys gave way to others of their frames");
  c.settings.pose.keys = std::move(moved);
  c.keyed_frame.reset();
}

// Undoes or redoes: with keys a pose is that of its frame.
void go_to_step(Controls& c, bool back) {
  if (c.brush.kind) {
    c.requests.step_back = back;
    return;
  }
  const bool had_keys = !c.settings.pose.keys.empty();
  const std::map<int, shots::CameraKey> cameras = c.settings.shot_camera.keys;
  const auto step = back ? &PoseHistory::undo : &PoseHistory::redo;
  const std::optional<int> frame = (c.poses.*step)(c.settings, c.playback.frame());
  if (c.settings.shot_camera.keys != cameras) c.shot_frame.reset();
  if (!frame) return c.say(back ? "nothing to undo: only turns, controls and keys are" : "nothing to redo");
  if (!had_keys && c.settings.pose.keys.empty()) return;
  c.playback.scrub(*frame);
  c.keyed_frame = c.playback.frame();
}

// Returns the joint that is named, or all that are selected.
std::vector<std::string> named_or_all_selected(const Controls& controls, const std::string& name) {
  const std::vector<std::string> selected = controls.selected();
  return name.empty() && !selected.empty() ? selected : std::vector{named_or_selected(controls, name)};
}

void paste(Controls& c, bool flips) {
  if (!c.copied) throw Error(ErrorKind::usage, "no pose was copied: 'copy' (Ctrl+C)");
  const auto& [pose, joints] = *c.copied;
  put_pose(c, flips ? flipped(c, pose, c.playback.frame()) : pose, flips ? flipped(c, joints) : joints,
           c.settings.pose);
}

// Blends the two keys around the frame that is shown, at this share of the way, for some joints or for all.
void tween(Controls& c, double share) {
  const std::map<int, shots::ViewSettings::PoseKey>& keys = c.settings.pose.keys;
  const auto after = keys.upper_bound(c.playback.frame());
  auto before = keys.lower_bound(c.playback.frame());
  if (before == keys.begin() || after == keys.end()) {
    throw Error(ErrorKind::usage, "frame ", c.playback.frame(), " has no key before and after it");
  }
  put_pose(c, shots::blended((--before)->second, after->second, share), c.selected(), c.settings.pose);
}

// Switches a tool on alone, or all tools.
template <Tool tool>
constexpr Command tool_command(const char* name, const char* help) {
  constexpr auto run = [](Controls& c, const std::string& a) {
    bool held = c.tool == tool;
    toggle(held, a);
    if (held || c.tool == tool) c.tool = held ? tool : Tool::all;
  };
  return {name, "[on|off]", "", "Pose", help, run, [](const Controls& c) { return name_of(c.tool == tool); }};
}

const Command kPoseCommands[] = {
    {"select", "[JOINT]", "", "Pose", "a joint; nothing: none",
     [](Controls& c, const std::string& a) { c.select(a.empty() ? a : known(a, c.joint_names, "joint")); }},
    {"select-also", "JOINT", "", "Pose", "one more joint, or one less, as Ctrl+click",
     [](Controls& c, const std::string& a) {
       const std::string joint = known(a, c.joint_names, "joint");
       if (c.joint.empty()) {
         c.joint = joint;
       } else if (joint == c.joint) {
         c.joint = c.also.empty() ? "" : c.also.extract(c.also.begin()).value();
       } else if (c.also.erase(joint) == 0) {
         c.also.insert(joint);
       }
     }},
    tool_command<Tool::move>("move-tool", "only arrows to drag by, where it may move"),
    tool_command<Tool::turn>("turn-tool", "only rings to drag by"),
    {"turn", "JOINT X Y Z", "", "Pose", "a joint on top of the clip, degrees",
     [](Controls& c, const std::string& a) {
       const auto [joint, angles] = joint_and_three(a, "a joint and three angles in degrees", shots::kMostTurn);
       c.settings.pose.joints[known(joint, c.joint_names, "joint")] = angles;
     }},
    {"axis", "NAME DEGREES", "", "Pose", "a joint along an axis of its limits, on top of the clip",
     [](Controls& c, const std::string& a) {
       const auto [name, angle] = split_last(a, "an axis and an angle in degrees");
       c.settings.pose.axes[known(name, c.axis_names, "axis of the joint limits")] =
           number_within(angle, -shots::kMostTurn, shots::kMostTurn);
     }},
    {"move", "JOINT X Y Z", "", "Pose", "hips, root, or what may move, on top of the clip, metres; pins hold meanwhile",
     [](Controls& c, const std::string& a) {
       const auto [joint, by] = joint_and_three(a, "a joint and three distances in metres", shots::kFurthest);
       c.settings.pose.moves[known(joint, c.movable_names, "joint that may move")] = by;
     }},
    {"limits", "[FILE.json|none]", "", "Pose", "of the lead's joints; turns end there",
     [](Controls& c, const std::string& a) {
       if (a.empty()) return c.browse("limits");
       c.requests.limits = a;
     }},
    {"pin", "[JOINT] [X Y Z]", "", "Pose",
     "the end of a limb where it is, or a joint at a point of the world, metres: the limb reaches for it",
     [](Controls& c, const std::string& a) {
       if (a.empty() || std::ranges::find(c.joint_names, a) != c.joint_names.end()) {
         c.requests.pin = PinRequest{named_or_selected(c, a)};
         return;
       }
       const auto [joint, at] = joint_and_three(a, "a joint, or a joint and a point", shots::kFurthest);
       c.requests.pin = PinRequest{known(joint, c.joint_names, "joint"), at};
     }},
    {"unpin", "[JOINT]", "", "Pose", "lets go of the joint that is selected",
     [](Controls& c, const std::string& a) {
       const std::string joint = named_or_selected(c, a);
       c.settings.pose.facing.erase(joint);
       if (c.settings.pose.pins.erase(joint) == 0) c.say(joint + " has no pin");
     }},
    {"move-key", "FROM TO", "", "Keys", "the key of a frame to another",
     [](Controls& c, const std::string& a) {
       if (move_key(c, c.settings.pose.keys, a)) c.keyed_frame.reset();
     }},
    {"key", "", "Alt+K", "Keys", "keeps the pose as a key of this frame",
     [](Controls& c, const std::string&) {
       c.settings.pose.keys[c.playback.frame()] = c.settings.pose;
       c.keyed_frame = c.playback.frame();
     }},
    {"ease", "smooth|linear|step|spline", "", "Keys", "from the key of this frame to the next; spline: on through both",
     [](Controls& c, const std::string& a) {
       shots::ViewSettings::PoseKey& key = require_key(c, c.settings.pose.keys);
       choose(key.ease, a, shots::kKeyEaseNames);
       c.settings.pose.ease = key.ease;
     },
     [](const Controls& c) { return name_of(c.settings.pose.ease, shots::kKeyEaseNames); }},
    {"ease-joints", "key|smooth|linear|step|spline", "", "Keys", "the same of selected joints; key: as the key",
     [](Controls& c, const std::string& a) {
       std::optional<shots::KeyEase> ease;
       if (a != "key") choose(ease.emplace(), a, shots::kKeyEaseNames);
       std::map<std::string, shots::KeyEase>& eases = require_key(c, c.settings.pose.keys).eases;
       for (const std::string& joint : named_or_all_selected(c, "")) {
         std::vector<std::string> names = axes_turning(c, joint);
         names.push_back(joint);
         for (const std::string& name : names) {
           eases.erase(name);
           if (ease) eases[name] = *ease;
         }
       }
       c.settings.pose.eases = eases;
     },
     [](const Controls& c) {
       const auto own = c.settings.pose.eases.find(c.joint);
       return own == c.settings.pose.eases.end() ? std::string("key") : name_of(own->second, shots::kKeyEaseNames);
     }},
    {"shift-keys", "FRAMES", "", "Keys", "all keys of the range, to later frames",
     [](Controls& c, const std::string& a) {
       const int by = integer(a);
       move_keys(c, true, [&](int frame) { return frame + by; });
     }},
    {"repeat-keys", "FRAME", "", "Keys", "all keys of the range once more, from there on",
     [](Controls& c, const std::string& a) {
       const int from = integer(a);
       move_keys(c, false, [&](int frame) { return from + frame - c.playback.in(); });
     }},
    {"scale-keys", "FACTOR", "", "Keys", "all keys of the range: times as far from its beginning",
     [](Controls& c, const std::string& a) {
       const double factor = number_within(a, 0.01, 100);
       move_keys(c, true, [&](int frame) {
         return c.playback.in() + static_cast<int>(std::lround(factor * (frame - c.playback.in())));
       });
     }},
    {"unkey", "", "", "Keys", "forgets the key of this frame",
     [](Controls& c, const std::string&) {
       const int frame = c.playback.frame();
       if (c.settings.pose.keys.erase(frame) == 0) c.say("frame " + std::to_string(frame) + " has no key");
       c.keyed_frame.reset();
     }},
    {"mirror", "[JOINT]", "P", "Pose", "poses the other side as selected joints",
     [](Controls& c, const std::string& a) {
       const std::vector<std::string> joints = named_or_all_selected(c, a);
       const auto is_middle = [&](const std::string& joint) { return mirrored_name(joint, c.joint_names).empty(); };
       if (std::ranges::all_of(joints, is_middle)) refuse(joints.front(), "a joint that another side has, too");
       put_pose(c, flipped(c, part_of(c, c.settings.pose, joints), c.playback.frame()), flipped(c, joints),
                c.settings.pose);
     }},
    {"copy", "", "Ctrl+C", "Pose", "the pose, or what selected joints have of it",
     [](Controls& c, const std::string&) {
       c.copied = CopiedPose{part_of(c, c.settings.pose, c.selected()), c.selected()};
     }},
    {"paste", "", "Ctrl+V", "Pose", "what was copied", [](Controls& c, const std::string&) { paste(c, false); }},
    {"paste-flipped", "", "Ctrl+Shift+V", "Pose", "what was copied, left and right exchanged",
     [](Controls& c, const std::string&) { paste(c, true); }},
    {"flip-keys", "", "", "Keys", "left and right exchanged in all keys of the range",
     [](Controls& c, const std::string&) {
       for (auto& [frame, key] : c.settings.pose.keys) {
         if (c.playback.in() <= frame && frame <= c.playback.out()) key = flipped(c, key, frame);
       }
       c.keyed_frame.reset();
     }},
    {"tween", "0-1", "", "Keys", "the pose on the way from the key before to the next",
     [](Controls& c, const std::string& a) { tween(c, number_within(a, 0, 1)); }},
    switch_command<&Controls::dope_sheet>("dope-sheet", "Shift+K", "Keys", "all keys under the timeline"),
    {"curves", "[on|off]", "Ctrl+K", "Keys", "the dope sheet shows curves of selected joints",
     [](Controls& c, const std::string& a) {
       c.curves = c.curves && c.dope_sheet;
       toggle(c.curves, a);
       c.dope_sheet |= c.curves;
     },
     [](const Controls& c) { return name_of(c.curves && c.dope_sheet); }},
    switch_command<&Controls::auto_key>("auto-key", "", "Keys", "what is posed is a key of its frame at once"),
    {"save-pose", "FILE.json", "", "Pose", "the pose, or what of it several joints have",
     [](Controls& c, const std::string& a) {
       require_ending(a, ".json");
       c.requests.save_pose = a;
     }},
    {"load-pose", "FILE.json [0-1]", "", "Pose", "a pose that was saved, or a share of it, over the one in hand",
     [](Controls& c, const std::string& a) {
       if (a.ends_with(".json")) {
         c.requests.load_pose = PoseRequest{a};
         return;
       }
       const auto [file, share] = split_last(a, "a file that ends in .json, and a share");
       if (!file.ends_with(".json")) refuse(a, "a file that ends in .json, and a share");
       c.requests.load_pose = PoseRequest{file, number_within(share, 0, 1)};
     }},
    {"reset-joint", "[JOINT]", "R", "Pose", "what is selected as the clip has it",
     [](Controls& c, const std::string& a) { put_pose(c, {}, named_or_all_selected(c, a), c.settings.pose); }},
    {"control", "NAME VALUE", "", "Pose", "a control of the basis, as a muscle's activation",
     [](Controls& c, const std::string& a) {
       const auto [name, value] = split_last(a, "a control and a number");
       c.settings.pose.controls[known(name, c.control_names, "control of the basis")] =
           number_within(value, -shots::kMostControl, shots::kMostControl);
     }},
    {"reset-pose", "", "Shift+R", "Pose", "the pose as the clip has it",
     [](Controls& c, const std::string&) { put_pose(c, {}, {}, c.settings.pose); }},
    {"undo", "", "Ctrl+Z", "Pose", "the posing before the last change; with a brush in hand: undo-edit",
     [](Controls& c, const std::string&) { go_to_step(c, true); }},
    {"redo", "", "Ctrl+Shift+Z", "Pose", "the posing that was undone; with a brush in hand: redo-edit",
     [](Controls& c, const std::string&) { go_to_step(c, false); }},
    {"correction", "0-1", "", "Pose", "how much is shown of what was learned",
     [](shots::ViewSettings::Posing& pose, const std::string& a) { pose.correction = number_within(a, 0, 1); }},
    switch_command<&shots::ViewSettings::Jiggling::on>("jiggle", "J", "Pose", "flesh that moves by inertia"),
    {"jiggle-amount", "0-4", "", "Pose", "how much is shown of the jiggle",
     [](shots::ViewSettings::Jiggling& jiggle, const std::string& a) {
       jiggle.amount = number_within(a, 0, shots::kMostJiggle);
     }},
    request_command<&Requests::reset_jiggle>("reset-jiggle", "", "Pose", "the jiggle begins anew"),
};

}  // namespace

std::span<const Command> playback_commands() { return kPlaybackCommands; }

std::span<const Command> pose_commands() { return kPoseCommands; }

}  // namespace bodyopt::viewport
