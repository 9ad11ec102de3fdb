#include "proxy_viewer/commands/commands.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <sstream>
#include <tuple>
#include <utility>
#include <vector>

#include "assets/notes.h"
#include "proxy_viewer/state/mirrored_joint.h"
#include "proxy_viewer/state/sections.h"
#include "proxy_viewer/state/setting_fields.h"
#include "runtime/core/error.h"

namespace bodyopt {
namespace {

constexpr const char* kBlank = " \t\r";

[[noreturn]] void refuse(const std::string& argument, const std::string& expected) {
  throw Error(ErrorKind::usage, "'" + argument + "' is not " + expected);
}

// Throws Error(usage) for a name that is none of these.
const std::string& known(const std::string& name, const std::vector<std::string>& names, const char* what) {
  if (names.empty()) refuse(name, std::string("a ") + what + ": there is none");
  if (std::find(names.begin(), names.end(), name) != names.end()) return name;
  refuse(name, std::string("a ") + what + "; the nearest is '" + nearest_names(names, name).front() + "'");
}

const std::string& selected(const Controls& controls) {
  if (controls.joint.empty()) throw Error(ErrorKind::usage, "no joint is selected, nor was one named");
  return controls.joint;
}

double number(const std::string& text) {
  double value = 0;
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (problem != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) refuse(text, "a number");
  return value;
}

double number_within(const std::string& text, double low, double high) {
  const double value = number(text);
  if (value < low || value > high) {
    std::ostringstream expected;
    expected << "a number from " << low << " to " << high;
    refuse(text, expected.str());
  }
  return value;
}

int integer(const std::string& text) {
  int value = 0;
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (problem != std::errc{} || end != text.data() + text.size()) refuse(text, "a whole number");
  return value;
}

int frame_of_clip(const Controls& controls, const std::string& text) {
  const int frame = integer(text);
  controls.playback.require_frame(frame);
  return frame;
}

int integer_within(const std::string& text, int low, int high) {
  const int value = integer(text);
  if (value < low || value > high) {
    refuse(text, "a whole number from " + std::to_string(low) + " to " + std::to_string(high));
  }
  return value;
}

std::vector<std::string> words(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> all;
  for (std::string word; stream >> word;) all.push_back(word);
  return all;
}

std::vector<std::string> words(const std::string& text, std::size_t count, const std::string& expected) {
  const std::vector<std::string> all = words(text);
  if (all.size() != count) refuse(text, expected);
  return all;
}

// One of the names, in the order of the enumeration.
template <typename Choice, std::size_t N>
void choose(Choice& choice, const std::string& text, const std::array<const char*, N>& names) {
  std::string expected = "one of";
  for (std::size_t k = 0; k < N; ++k) {
    if (text == names[k]) {
      choice = static_cast<Choice>(k);
      return;
    }
    expected += std::string(" ") + names[k];
  }
  refuse(text, expected);
}

template <typename Choice, std::size_t N>
std::string name_of(Choice choice, const std::array<const char*, N>& names) {
  return names[static_cast<std::size_t>(choice)];
}

template <typename Choice, std::size_t N>
void choose_next(Choice& choice, const std::array<const char*, N>&) {
  choice = static_cast<Choice>((static_cast<std::size_t>(choice) + 1) % N);
}

constexpr std::array kSwitchNames{"off", "on"};

std::string name_of(bool on) { return name_of(on, kSwitchNames); }

// Without an argument the other way round.
void toggle(bool& value, const std::string& argument) {
  if (argument.empty()) {
    value = !value;
  } else {
    choose(value, argument, kSwitchNames);
  }
}

void require_keys(const Playback& playback) {
  if (!playback.keys().empty()) return;
  throw Error(ErrorKind::usage,
              "the clip has no keys to go to: a BVH samples its motion, and so does a clip with a key at most frames");
}

// What is before the last blank, and the word after it.
std::pair<std::string, std::string> split_last(const std::string& text, const std::string& expected) {
  const std::size_t blank = text.find_last_of(kBlank);
  const std::size_t end = blank == std::string::npos ? blank : text.find_last_not_of(kBlank, blank);
  if (end == std::string::npos) refuse(text, expected);
  return {text.substr(0, end + 1), text.substr(blank + 1)};
}

// Of the bind pose, joint to world; `joint` is one of joint_names.
const Quat& axes_of(const Controls& controls, const std::string& joint) {
  const auto at = std::find(controls.joint_names.begin(), controls.joint_names.end(), joint);
  return controls.joint_axes.at(static_cast<std::size_t>(at - controls.joint_names.begin()));
}

// Of one of the cast, which are counted from 1, but the lead.
Standing& standing_of(Controls& controls, const std::string& number) {
  const int index = integer(number);
  if (index >= 2 && static_cast<std::size_t>(index) <= controls.standings.size()) {
    return controls.standings[static_cast<std::size_t>(index) - 1];
  }
  refuse(number, "one of the cast but the lead, expected a number from 2 to " +
                     std::to_string(controls.standings.size()) + ", as the cast panel counts them");
}

// Of a vertex of one of the cast.
std::uint32_t vertex_of(const Controls& controls, std::size_t character, const std::string& number) {
  if (character >= controls.output_counts.size()) {
    throw Error(ErrorKind::usage, "markers are of two bodies: open the one that is transferred to after the lead");
  }
  const int last = static_cast<int>(controls.output_counts[character]) - 1;
  return static_cast<std::uint32_t>(integer_within(number, 0, last));
}

// "auto", or a whole number within these.
std::optional<int> automatic_or(const std::string& text, int low, int high) {
  return text == "auto" ? std::nullopt : std::optional(integer_within(text, low, high));
}

void go_to_pair(Controls& controls, int pair) {
  controls.curating.pair = pair;
  controls.playback.pause();
  const ListedPair& listed = controls.curating.pairs[static_cast<std::size_t>(pair)];
  controls.curating.region = listed.region;
  controls.playback.scrub(listed.first);
}

constexpr double kTurn = std::numbers::pi / 36;  // 5 degrees
constexpr double kMostPan = 100;
constexpr bool kRepeats = true;

const Command kCommands[] = {
    {"play", "", "Space", "Playback", "play or pause",
     [](Controls& c, const std::string&) { c.playback.toggle(); },
     [](const Controls& c) { return name_of(c.playback.playing()); }},
    {"step", "[FRAMES]", "Right", "Playback", "one frame on",
     [](Controls& c, const std::string& a) { c.playback.step(a.empty() ? 1 : integer(a)); }, nullptr, kRepeats},
    {"step-back", "", "Left", "Playback", "one frame back",
     [](Controls& c, const std::string&) { c.playback.step(-1); }, nullptr, kRepeats},
    {"first", "", "Home", "Playback", "to the first frame of the range",
     [](Controls& c, const std::string&) { c.playback.go_to_in(); }},
    {"last", "", "End", "Playback", "to the last frame of the range",
     [](Controls& c, const std::string&) { c.playback.go_to_out(); }},
    {"next-key", "", "Up", "Playback", "to the next key",
     [](Controls& c, const std::string&) {
       require_keys(c.playback);
       c.playback.go_to_next_key();
     }, nullptr, kRepeats},
    {"previous-key", "", "Down", "Playback", "to the key before",
     [](Controls& c, const std::string&) {
       require_keys(c.playback);
       c.playback.go_to_previous_key();
     }, nullptr, kRepeats},
    {"frame", "FRAME", "", "Playback", "to a frame", 
     [](Controls& c, const std::string& a) { c.playback.scrub(frame_of_clip(c, a)); }},
    {"backwards", "[on|off]", "B", "Playback", "play backwards",
     [](Controls& c, const std::string& a) {
       bool backwards = c.playback.backwards();  // as it goes now, in ping-pong
       toggle(backwards, a);
       c.playback.set_backwards(backwards);
     },
     [](const Controls& c) { return name_of(c.playback.backwards()); }},
    {"mode", "loop|ping-pong|once", "", "Playback", "what happens at the end of the range",
     [](Controls& c, const std::string& a) {
       PlayMode mode = c.playback.mode();
       choose(mode, a, kPlayModeNames);
       c.playback.set_mode(mode);
     },
     [](const Controls& c) { return name_of(c.playback.mode(), kPlayModeNames); }},
    {"speed", "0.1-2", "", "Playback", "of playing; 1: as it is",
     [](Controls& c, const std::string& a) {
       const double speed = number_within(a, Playback::kSlowest, Playback::kFastest);
       c.playback.set_speed(speed);
     }},
    {"every-frame", "[on|off]", "", "Playback", "drop no frame, however long it takes",
     [](Controls& c, const std::string& a) {
       bool every = !c.playback.real_time();
       toggle(every, a);
       c.playback.set_real_time(!every);
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
     [](Controls& c, const std::string&) {
       c.playback.set_range(c.playback.first(), c.playback.last());
     }},
    {"live", "[on|off]", "", "Playback", "poses that another program sends, or the clip",
     [](Controls& c, const std::string& a) {
       if (!c.live) throw Error(ErrorKind::usage, "no poses are listened for: begin with --live PORT");
       toggle(*c.live, a);
     },
     [](const Controls& c) { return name_of(c.live.value_or(false)); }},

    {"frame-selection", "", "F", "Camera", "see all of the character, or of the joint that is selected",
     [](Controls& c, const std::string&) { c.requests.frame_selection = true; }},
    {"front", "", "1", "Camera", "from the front",
     [](Controls& c, const std::string&) { c.camera.view_axis(AxisView::front); }},
    {"back", "", "Ctrl+1", "Camera", "from behind",
     [](Controls& c, const std::string&) { c.camera.view_axis(AxisView::back); }},
    {"right", "", "3", "Camera", "from the right of the picture: the character's left side",
     [](Controls& c, const std::string&) { c.camera.view_axis(AxisView::right); }},
    {"left", "", "Ctrl+3", "Camera", "from the left of the picture: the character's right side",
     [](Controls& c, const std::string&) { c.camera.view_axis(AxisView::left); }},
    {"top", "", "7", "Camera", "from above",
     [](Controls& c, const std::string&) { c.camera.view_axis(AxisView::top); }},
    {"bottom", "", "Ctrl+7", "Camera", "from below",
     [](Controls& c, const std::string&) { c.camera.view_axis(AxisView::bottom); }},
    {"orthographic", "[on|off]", "5", "Camera", "without perspective, or with it",
     [](Controls& c, const std::string& a) {
       bool wanted = c.camera.view().orthographic;
       toggle(wanted, a);
       if (wanted != c.camera.view().orthographic) c.camera.toggle_orthographic();
     },
     [](const Controls& c) { return name_of(c.camera.view().orthographic); }},
    {"follow", "[on|off]", "V", "Camera", "go along with the character",
     [](Controls& c, const std::string& a) { toggle(c.settings.look.follow, a); },
     [](const Controls& c) { return name_of(c.settings.look.follow); }},
    {"orbit", "DEGREES DEGREES", "", "Camera", "around the target, to the right and up",
     [](Controls& c, const std::string& a) {
       const auto w = words(a, 2, "two angles in degrees");
       c.camera.orbit(number(w[0]) * std::numbers::pi / 180, number(w[1]) * std::numbers::pi / 180);
     }},
    {"orbit-left", "", "Shift+Left", "Camera", "5 degrees to the left",
     [](Controls& c, const std::string&) { c.camera.orbit(-kTurn, 0); }, nullptr, kRepeats},
    {"orbit-right", "", "Shift+Right", "Camera", "5 degrees to the right",
     [](Controls& c, const std::string&) { c.camera.orbit(kTurn, 0); }, nullptr, kRepeats},
    {"pan", "RIGHT UP", "", "Camera", "the target, by shares of the picture's height",
     [](Controls& c, const std::string& a) {
       const auto w = words(a, 2, "two shares of the picture's height");
       c.camera.pan(-number_within(w[0], -kMostPan, kMostPan), number_within(w[1], -kMostPan, kMostPan), 1);
     }},
    {"dolly", "NOTCHES", "", "Camera", "towards the target",
     [](Controls& c, const std::string& a) { c.camera.dolly(number_within(a, -100, 100)); }},
    {"save-camera", "NAME", "", "Camera", "keeps the camera by a name",
     [](Controls& c, const std::string& a) {
       if (a.empty()) refuse(a, "a name");
       c.settings.cameras[a] = c.kept_camera();
     }},
    {"camera", "NAME", "", "Camera", "to a camera that was kept",
     [](Controls& c, const std::string& a) {
       const auto found = c.settings.cameras.find(a);
       if (found == c.settings.cameras.end()) refuse(a, "a camera that was kept");
       c.go_to_camera(found->second);
     }},
    {"forget-camera", "NAME", "", "Camera", "a camera that was kept",
     [](Controls& c, const std::string& a) {
       if (c.settings.cameras.erase(a) == 0) refuse(a, "a camera that was kept");
     }},

    {"style", "clay|matcap|flat|normals", "", "Look", "how skin looks",
     [](Controls& c, const std::string& a) { choose(c.settings.look.style, a, kStyleNames); },
     [](const Controls& c) { return name_of(c.settings.look.style, kStyleNames); }},
    {"next-style", "", "S", "Look", "clay, matcap, flat, normals",
     [](Controls& c, const std::string&) { choose_next(c.settings.look.style, kStyleNames); }},
    {"wire", "[on|off]", "W", "Look", "edges over the surface",
     [](Controls& c, const std::string& a) { toggle(c.settings.look.wire, a); },
     [](const Controls& c) { return name_of(c.settings.look.wire); }},
    {"skeleton", "[on|off]", "K", "Look", "joints and bones, seen through the skin",
     [](Controls& c, const std::string& a) { toggle(c.settings.look.skeleton, a); },
     [](const Controls& c) { return name_of(c.settings.look.skeleton); }},
    {"fibres", "[on|off]", "M", "Look", "muscle fibres, coloured by strain",
     [](Controls& c, const std::string& a) { toggle(c.settings.look.fibres, a); },
     [](const Controls& c) { return name_of(c.settings.look.fibres); }},
    {"tets", "[on|off]", "T", "Look", "the tetrahedra of the jiggle, cut open",
     [](Controls& c, const std::string& a) { toggle(c.settings.look.tets, a); },
     [](const Controls& c) { return name_of(c.settings.look.tets); }},
    {"tet-cut", "0-1", "", "Look", "share of the body that is cut away, from the front",
     [](Controls& c, const std::string& a) { c.settings.look.tet_cut = number_within(a, 0, 1); }},
    {"level", "auto|0|1|2...", "", "Look", "of detail, 0 the finest; auto: the one that keeps up",
     [](Controls& c, const std::string& a) { c.settings.look.level = automatic_or(a, 0, kCoarsestLevel); }},
    {"grid", "[on|off]", "D", "Look", "the grid on the ground",
     [](Controls& c, const std::string& a) { toggle(c.settings.look.grid, a); },
     [](const Controls& c) { return name_of(c.settings.look.grid); }},
    {"axes", "[on|off]", "A", "Look", "the world's axes",
     [](Controls& c, const std::string& a) { toggle(c.settings.look.axes, a); },
     [](const Controls& c) { return name_of(c.settings.look.axes); }},
    {"shadow", "[on|off]", "", "Look", "the shadow on the ground",
     [](Controls& c, const std::string& a) { toggle(c.settings.look.shadow, a); },
     [](const Controls& c) { return name_of(c.settings.look.shadow); }},
    {"worn", "[on|off]", "", "Look", "clothes, eyes and what else is attached to the skin",
     [](Controls& c, const std::string& a) { toggle(c.settings.look.worn, a); },
     [](const Controls& c) { return name_of(c.settings.look.worn); }},

    {"compare", "none|lbs|ddm|linear|full|jiggle|truth|proxy", "", "Compare", "with what",
     [](Controls& c, const std::string& a) {
       choose(c.settings.compare.with, a, kComparisonNames);
       const CompareWith shown = c.settings.jiggle.on ? CompareWith::jiggle : CompareWith::full;
       if (c.settings.compare.with == shown) c.say("that is what is shown: there is nothing beside it");
     },
     [](const Controls& c) { return name_of(c.settings.compare.with, kComparisonNames); }},
    {"layout", "side-by-side|overlay|wipe|hold", "", "Compare", "of a comparison",
     [](Controls& c, const std::string& a) { choose(c.settings.compare.layout, a, kLayoutNames); },
     [](const Controls& c) { return name_of(c.settings.compare.layout, kLayoutNames); }},
    {"next-layout", "", "L", "Compare", "side by side, overlay, wipe, hold",
     [](Controls& c, const std::string&) { choose_next(c.settings.compare.layout, kLayoutNames); }},
    {"wipe", "0-1", "", "Compare", "where, of the picture's width",
     [](Controls& c, const std::string& a) { c.settings.compare.wipe = number_within(a, 0, 1); }},
    {"heat", "[on|off]", "E", "Compare", "colour by the distance, in millimetres",
     [](Controls& c, const std::string& a) { toggle(c.settings.compare.heat, a); },
     [](const Controls& c) { return name_of(c.settings.compare.heat); }},
    {"heat-scale", "auto|MM", "", "Compare", "the hottest colour; auto: by what was measured",
     [](Controls& c, const std::string& a) {
       if (a == "auto") {
         c.settings.compare.heat_scale_mm = std::nullopt;
       } else {
         c.settings.compare.heat_scale_mm = number_within(a, kFinestHeat, kCoarsestHeat);
       }
     }},
    {"activation", "[on|off]", "", "Compare", "colour by what was learned: the distance to Direct Delta Mush",
     [](Controls& c, const std::string& a) { toggle(c.settings.compare.activation, a); },
     [](const Controls& c) { return name_of(c.settings.compare.activation); }},
    {"coverage", "[on|off]", "", "Compare", "colour by the error to expect of the pose, in millimetres",
     [](Controls& c, const std::string& a) { toggle(c.settings.compare.coverage, a); },
     [](const Controls& c) { return name_of(c.settings.compare.coverage); }},
    {"match", "none|colours|confidence", "", "Compare",
     "colour the lead and the second of the cast by which point is which, or by how sure that is",
     [](Controls& c, const std::string& a) { choose(c.settings.compare.match, a, kMatchNames); },
     [](const Controls& c) { return name_of(c.settings.compare.match, kMatchNames); }},
    {"worst-frame", "", "N", "Compare", "to the frame that is furthest from what it is compared with",
     [](Controls& c, const std::string&) { c.requests.worst_frame = true; }},
    {"worst-vertex", "", "Shift+N", "Compare", "to the vertex that is furthest off in this frame",
     [](Controls& c, const std::string&) { c.requests.worst_vertex = true; }},

    {"region", "NAME", "", "Compare", "of the dataset's map of poses",
     [](Controls& c, const std::string& a) { c.curating.region = known(a, c.curating.regions, "region"); }},
    {"map-colour", "coverage|contradiction|error|sculpt", "", "Compare",
     "of the map: thin data, like poses that disagree, the distance, or what takes part in the last stroke",
     [](Controls& c, const std::string& a) { choose(c.curating.colour, a, kMapColourNames); },
     [](const Controls& c) { return name_of(c.curating.colour, kMapColourNames); }},
    {"raw", "[on|off]", "", "Compare", "the dataset's shapes before any modifier",
     [](Controls& c, const std::string& a) { toggle(c.curating.raw, a); },
     [](const Controls& c) { return name_of(c.curating.raw); }},
    {"modifier", "NAME on|off", "", "Compare", "switches a modifier of the dataset",
     [](Controls& c, const std::string& a) {
       const auto [name, state] = split_last(a, "a modifier, and on or off");
       if (state != "on" && state != "off") refuse(state, "on or off");
       c.requests.edits.push_back({.name = known(name, c.curating.modifiers, "modifier"), .enabled = state == "on"});
     }},
    {"strength", "NAME 0-1", "", "Compare", "of a modifier of the dataset",
     [](Controls& c, const std::string& a) {
       const auto [name, strength] = split_last(a, "a modifier and a strength");
       c.requests.edits.push_back({.name = known(name, c.curating.modifiers, "modifier"), .strength = number_within(strength, 0, 1)});
     }},
    {"undo-edit", "", "", "Compare", "the dataset's stack before the last edit",
     [](Controls& c, const std::string&) { c.requests.step_back = true; }},
    {"redo-edit", "", "", "Compare", "the edit of the stack that was undone",
     [](Controls& c, const std::string&) { c.requests.step_back = false; }},
    {"brush", "none|grab|smooth|inflate|flatten|erase", "", "Compare", "what the mouse does to the dataset's skin; none: it turns the view",
     [](Controls& c, const std::string& a) {
       if (a == "none") {
         c.brush.kind = std::nullopt;
         return;
       }
       BrushKind kind{};
       choose(kind, a, kBrushKindNames);
       if (c.curating.regions.empty()) throw Error(ErrorKind::usage, "no dataset is open: begin with bodyopt view DATASET");
       c.brush.kind = kind;
       c.settings.compare.with = CompareWith::truth;  // or its skin would not be seen
     },
     [](const Controls& c) { return c.brush.kind ? name_of(*c.brush.kind, kBrushKindNames) : "none"; }},
    {"brush-radius", "MM", "", "Compare", "of the brush, along the skin",
     [](Controls& c, const std::string& a) { c.brush.radius_mm = number_within(a, kFinestBrush, kWidestBrush); }},
    {"brush-strength", "0-1", "", "Compare", "of the brush",
     [](Controls& c, const std::string& a) { c.brush.strength = number_within(a, 0, 1); }},
    {"brush-symmetry", "[on|off]", "", "Compare", "the brush does the same on the other side of the body",
     [](Controls& c, const std::string& a) { toggle(c.brush.symmetric, a); },
     [](const Controls& c) { return name_of(c.brush.symmetric); }},
    {"brush-spread", "auto|DEGREES", "", "Compare", "to poses how near a stroke reaches; auto: as the modifier's",
     [](Controls& c, const std::string& a) {
       if (a == "auto") {
         c.brush.spread = std::nullopt;
       } else {
         c.brush.spread = number_within(a, 0, kWidestSpread);
       }
     }},
    {"brush-modifier", "NAME", "", "Compare", "the sculpt of the dataset's stack that takes strokes; a new name makes one",
     [](Controls& c, const std::string& a) { c.brush.modifier = a; }},
    {"stroke", "X Y [X Y ...]", "", "Compare", "of the brush through points of the picture, by shares of its width and height",
     [](Controls& c, const std::string& a) {
       const std::vector<std::string> w = words(a);
       if (w.size() % 2 != 0) refuse(a, "a list of points: two shares each");
       if (!c.brush.kind) throw Error(ErrorKind::usage, "no brush is in hand: 'brush grab'");
       PicturePath path;
       for (std::size_t k = 0; k < w.size(); k += 2) path.push_back({number_within(w[k], 0, 1), number_within(w[k + 1], 0, 1)});
       c.requests.stroke = std::move(path);
     }},
    {"keep-strokes", "", "", "Compare", "writes what was brushed and could not be written before",
     [](Controls& c, const std::string&) { c.requests.keep_strokes = true; }},
    {"contradictions", "", "", "Compare", "looks for like poses whose shapes disagree",
     [](Controls& c, const std::string&) { c.requests.contradictions = true; }},
    {"pair", "NUMBER", "", "Compare", "to the first of two frames that disagree, the worst from 1",
     [](Controls& c, const std::string& a) {
       if (c.curating.pairs.empty()) {
         throw Error(ErrorKind::usage, "no frames are known to disagree: 'contradictions' looks for them");
       }
       go_to_pair(c, integer_within(a, 1, static_cast<int>(c.curating.pairs.size())) - 1);
     }},
    {"next-pair", "", "", "Compare", "to the pair after that",
     [](Controls& c, const std::string&) {
       const auto count = static_cast<int>(c.curating.pairs.size());
       if (count > 0) go_to_pair(c, (c.curating.pair + 1) % count);
     }},
    {"other-of-pair", "", "", "Compare", "to the other of the two frames",
     [](Controls& c, const std::string&) {
       if (c.curating.pair < 0) return;
       const ListedPair& listed = c.curating.pairs[static_cast<std::size_t>(c.curating.pair)];
       c.playback.scrub(c.playback.frame() == listed.first ? listed.second : listed.first);
     }},

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
    {"pin", "JOINT [X Y Z]", "", "Pose", "the end of a limb where it is, or there, metres: the limb reaches for it",
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
       const std::string joint = a.empty() ? selected(c) : known(a, c.joint_names, "joint");
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
       const std::string joint = a.empty() ? selected(c) : known(a, c.joint_names, "joint");
       const std::string other = mirrored_joint(joint, c.joint_names);
       if (other.empty()) refuse(joint, "a joint that another side has, too");
       const auto turned = c.settings.pose.joints.find(joint);
       const Vec3 angles = turned == c.settings.pose.joints.end() ? Vec3{} : turned->second;
       c.settings.pose.joints[other] = mirrored_angles(angles, axes_of(c, joint), axes_of(c, other));
     }},
    {"reset-joint", "[JOINT]", "Shift+R", "Pose", "the joint that is selected as the clip has it",
     [](Controls& c, const std::string& a) {
       c.settings.pose.joints.erase(a.empty() ? selected(c) : known(a, c.joint_names, "joint"));
     }},
    {"control", "NAME VALUE", "", "Pose", "a control of the basis, as a muscle's activation",
     [](Controls& c, const std::string& a) {
       const auto [name, value] = split_last(a, "a control and a number");
       c.settings.pose.controls[known(name, c.control_names, "control of the basis")] =
           number_within(value, -kMostControl, kMostControl);
     }},
    {"reset-pose", "", "R", "Pose", "the pose as the clip has it",
     [](Controls& c, const std::string&) {
       static_cast<ViewSettings::PoseKey&>(c.settings.pose) = {};
     }},
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
     [](Controls& c, const std::string& a) { c.settings.pose.correction = number_within(a, 0, 1); }},
    {"jiggle", "[on|off]", "J", "Pose", "flesh that moves by inertia",
     [](Controls& c, const std::string& a) { toggle(c.settings.jiggle.on, a); },
     [](const Controls& c) { return name_of(c.settings.jiggle.on); }},
    {"jiggle-amount", "0-4", "", "Pose", "how much is shown of the jiggle",
     [](Controls& c, const std::string& a) { c.settings.jiggle.amount = number_within(a, 0, kMostJiggle); }},
    {"reset-jiggle", "", "", "Pose", "the jiggle begins anew",
     [](Controls& c, const std::string&) { c.requests.reset_jiggle = true; }},

    {"ghosts", "BEFORE AFTER", "", "Look", "frames before and after, see-through",
     [](Controls& c, const std::string& a) {
       const auto w = words(a, 2, "two counts");
       c.settings.ghosts.before = integer_within(w[0], 0, kMostGhosts);
       c.settings.ghosts.after = integer_within(w[1], 0, kMostGhosts);
     }},
    {"ghost-step", "FRAMES", "", "Look", "from one ghost to the next",
     [](Controls& c, const std::string& a) { c.settings.ghosts.step = integer_within(a, 1, kLongestGhostStep); }},
    {"ghost-opacity", "0-1", "", "Look", "of the ghost that is next; those beyond fade",
     [](Controls& c, const std::string& a) { c.settings.ghosts.opacity = number_within(a, 0, 1); }},
    {"toggle-ghosts", "[on|off]", "G", "Look", "two ghosts before and two after",
     [](Controls& c, const std::string& a) {
       ViewSettings::Ghosts& ghosts = c.settings.ghosts;
       const bool had = ghosts.before + ghosts.after > 0;
       bool has = had;
       toggle(has, a);
       if (has == had) return;
       ghosts.before = ghosts.after = has ? 2 : 0;
       if (has && ghosts.step == 1) ghosts.step = 4;
     },
     [](const Controls& c) { return name_of(c.settings.ghosts.before + c.settings.ghosts.after > 0); }},

    {"copies", "COUNT", "", "Look", "of the lead on the stage",
     [](Controls& c, const std::string& a) { c.settings.cast.copies = integer_within(a, 1, kMostCopies); }},
    {"copy-delay", "FRAMES", "", "Look", "from one copy to the next",
     [](Controls& c, const std::string& a) { c.settings.cast.delay = integer_within(a, 0, kLongestCopyDelay); }},

    {"mark", "[on|off]", "", "Compare", "clicks mark a vertex of the lead, then the same of the second of the cast",
     [](Controls& c, const std::string& a) {
       toggle(c.marking.on, a);
       c.marking.of_lead.reset();
     },
     [](const Controls& c) { return name_of(c.marking.on); }},
    {"marker", "VERTEX VERTEX", "", "Compare", "of the lead and of the second of the cast, that are the same",
     [](Controls& c, const std::string& a) {
       const std::vector<std::string> all = words(a, 2, "two numbers of vertices");
       add_marker(c, {vertex_of(c, 0, all[0]), vertex_of(c, 1, all[1])});
     }},
    {"unmark", "", "", "Compare", "takes the marker away that was set last",
     [](Controls& c, const std::string&) {
       if (c.marking.pairs.empty()) throw Error(ErrorKind::usage, "there is no marker");
       c.marking.pairs.pop_back();
     }},
    {"save-markers", "FILE.json", "", "File", "for bodyopt transfer --markers",
     [](Controls& c, const std::string& a) {
       if (!a.ends_with(".json")) refuse(a, "a file that ends in .json");
       c.requests.save_markers = a;
     }},

    {"place", "NUMBER X Y Z|auto", "", "Look", "where one of the cast begins, metres; auto: where there is room",
     [](Controls& c, const std::string& a) {
       const std::string expected = "a number of the cast and three coordinates, or auto";
       const std::vector<std::string> all = words(a);
       if (all.size() != 4 && !(all.size() == 2 && all[1] == "auto")) refuse(a, expected);
       std::optional<Vec3> at;
       if (all.size() == 4) {
         at.emplace();
         for (std::size_t i = 0; i < 3; ++i) (*at)[i] = number_within(all[i + 1], -kFurthest, kFurthest);
       }
       standing_of(c, all[0]).at = at;
     }},
    {"ahead", "NUMBER FRAMES|auto", "", "Playback", "one of the cast goes round in its own clip; auto: frame by frame",
     [](Controls& c, const std::string& a) {
       const std::vector<std::string> all = words(a, 2, "a number of the cast and a number of frames, or auto");
       standing_of(c, all[0]).ahead = automatic_or(all[1], -kFurthestAhead, kFurthestAhead);
     }},
    {"level-of", "NUMBER auto|0|1|2...", "", "Look", "of detail, of one of the cast; auto: by its size in the picture",
     [](Controls& c, const std::string& a) {
       const std::vector<std::string> all = words(a, 2, "a number of the cast and a level, or auto");
       standing_of(c, all[0]).level = automatic_or(all[1], 0, kCoarsestLevel);
     }},
    {"same-clip", "", "", "Playback", "all of the cast play the lead's clip",
     [](Controls& c, const std::string&) { c.requests.same_clip = true; }},

    {"screenshot", "[FILE.png]", "F12", "File", "the picture as it is",
     [](Controls& c, const std::string& a) { c.requests.screenshot = a; }},
    {"turntable", "FILE.####.png", "", "File", "once around, 72 pictures",
     [](Controls& c, const std::string& a) { c.requests.turntable = a; }},
    {"sequence", "FILE.####.png", "", "File", "a picture of every frame of the range; .webp: one that moves",
     [](Controls& c, const std::string& a) { c.requests.sequence = a; }},
    {"export-clip", "FILE.glb|.bvh", "", "File", "the motion of the range, as it is posed and keyed",
     [](Controls& c, const std::string& a) {
       if (!a.ends_with(".glb") && !a.ends_with(".bvh")) refuse(a, "a file that ends in .glb or .bvh");
       c.requests.export_clip = a;
     }},
    {"export-skin", "FILE.pc2|.usda", "", "File", "the lead's skin over the range, without jiggle",
     [](Controls& c, const std::string& a) {
       if (!a.ends_with(".pc2") && !a.ends_with(".usda")) refuse(a, "a file that ends in .pc2 or .usda");
       c.requests.export_skin = a;
     }},
    {"save", "FILE.json", "", "File", "the session: files, poses, keys, cameras and settings; open and eval read it",
     [](Controls& c, const std::string& a) {
       if (!a.ends_with(".json")) refuse(a, "a file that ends in .json");
       c.requests.save = a;
     }},
    {"browse", "open|save|save-state|load-state|export-clip|export-skin|screenshot|sequence|turntable", "", "File",
     "chooses the file of a command from the list of a folder",
     [](Controls& c, const std::string& a) { c.dialog = browse_folder(known(a, browsed_commands(), "command that takes a file"), "."); }},
    {"open", "FILE", "", "File", "a basis, character, clip, point cache, dataset or session",
     [](Controls& c, const std::string& a) { c.requests.open.push_back(a); }},
    {"lead", "NUMBER", "", "File", "the character of whom panels speak, and to whom clips and caches go",
     [](Controls& c, const std::string& a) { c.requests.lead = integer(a); }},
    {"remove", "NUMBER", "", "File", "a character of the cast; its files stay",
     [](Controls& c, const std::string& a) { c.requests.remove = integer(a); }},
    {"reload", "", "F5", "File", "read all files again", [](Controls& c, const std::string&) { c.requests.reload = true; }},
    {"save-state", "FILE.json", "", "File", "cameras and settings",
     [](Controls& c, const std::string& a) { c.requests.save_state = a; }},
    {"load-state", "FILE.json", "", "File", "cameras and settings",
     [](Controls& c, const std::string& a) { c.requests.load_state = a; }},
    {"panels", "[on|off]", "Tab", "View", "panels, or the picture alone",
     [](Controls& c, const std::string& a) { toggle(c.panels, a); },
     [](const Controls& c) { return name_of(c.panels); }},
    {"hud", "[on|off]", "Z", "View", "figures over the picture",
     [](Controls& c, const std::string& a) { toggle(c.settings.hud.on, a); },
     [](const Controls& c) { return name_of(c.settings.hud.on); }},
    {"legend", "[on|off]", "", "View", "names of what is compared, and what colours mean",
     [](Controls& c, const std::string& a) { toggle(c.settings.hud.legend, a); },
     [](const Controls& c) { return name_of(c.settings.hud.legend); }},
    {"cheat-sheet", "[on|off]", "H", "View", "all keys",
     [](Controls& c, const std::string& a) { toggle(c.cheat_sheet, a); },
     [](const Controls& c) { return name_of(c.cheat_sheet); }},
    {"prompt", "[on|off]", "Enter", "View", "type a command",
     [](Controls& c, const std::string& a) { toggle(c.prompt, a); },
     [](const Controls& c) { return name_of(c.prompt); }},
    {"side-panel", "[on|off]", "Q", "View", "the panel on the right",
     [](Controls& c, const std::string& a) { toggle(c.settings.hud.panels.try_emplace(kSidePanel, true).first->second, a); },
     [](const Controls& c) { return name_of(shows_side_panel(c.settings)); }},
    {"section", "look|cameras|compare|curate|pose|keys|modifiers|muscles|jiggle|ghosts|cast|transfer|output", "", "View",
     "opens a section of the side panel, and closes the others",
     [](Controls& c, const std::string& a) { open_section(c.settings, known(a, section_names(), "section of the side panel")); }},
    {"quit", "", "Ctrl+Q", "File", "close the viewport", [](Controls& c, const std::string&) { c.requests.quit = true; }},
};

}  // namespace

void add_marker(Controls& controls, const MarkedPair& pair) {
  for (const MarkedPair& there : controls.marking.pairs) {
    if (there.of_lead != pair.of_lead && there.of_second != pair.of_second) continue;
    throw Error(ErrorKind::usage, "vertex " + std::to_string(pair.of_lead) + " of the lead or " +
                                      std::to_string(pair.of_second) + " of the other is marked already");
  }
  controls.marking.pairs.push_back(pair);
}

std::vector<std::string> choices_of(const Command& command) {
  const std::string all = command.argument;
  std::vector<std::string> choices;
  if (all.find('|') == std::string::npos || all.find_first_not_of("abcdefghijklmnopqrstuvwxyz|-") < all.size()) {
    return choices;
  }
  std::istringstream stream(all);
  for (std::string choice; std::getline(stream, choice, '|');) choices.push_back(choice);
  return choices;
}

std::span<const Command> commands() { return kCommands; }

const Command* find_command(const std::string& name) {
  const auto found =
      std::find_if(std::begin(kCommands), std::end(kCommands), [&](const Command& c) { return name == c.name; });
  return found == std::end(kCommands) ? nullptr : found;
}

const Command* find_command_by_key(const std::string& key) {
  if (key.empty()) return nullptr;
  const auto found =
      std::find_if(std::begin(kCommands), std::end(kCommands), [&](const Command& c) { return key == c.key; });
  return found == std::end(kCommands) ? nullptr : found;
}

void run_command(Controls& controls, const std::string& text) {
  const std::size_t begin = std::min(text.find_first_not_of(kBlank), text.size());
  const std::size_t end = std::min(text.find_first_of(kBlank, begin), text.size());
  const std::string name = text.substr(begin, end - begin);
  const std::size_t argument = text.find_first_not_of(kBlank, end);
  const std::size_t last = text.find_last_not_of(kBlank);
  const Command* command = find_command(name);
  if (!command) {
    std::vector<std::string> names;
    for (const Command& c : kCommands) names.emplace_back(c.name);
    throw Error(ErrorKind::usage, "there is no command '" + name + "' in the viewport; the nearest is '" +
                                      nearest_names(names, name).front() + "'");
  }
  const std::string rest = argument == std::string::npos ? "" : text.substr(argument, last - argument + 1);
  if (rest.empty() && *command->argument != 0 && *command->argument != '[') {
    throw Error(ErrorKind::usage, name + ": expected " + command->argument);
  }
  if (!rest.empty() && *command->argument == 0) {
    throw Error(ErrorKind::usage, name + ": takes no argument, found '" + rest + "'");
  }
  // A switch without an argument turns round.
  const bool turns_on = rest.empty() && command->value && command->value(controls) == "off";
  const auto missing = controls.missing.find(name + " " + (turns_on ? "on" : rest));
  if (missing != controls.missing.end()) throw Error(ErrorKind::usage, missing->first + ": " + missing->second);
  controls.poses.note(controls.settings.pose);  // what sliders made of it
  try {
    command->run(controls, rest);
  } catch (const Error& error) {
    throw Error(error.kind(), name + ": " + error.what());
  }
}

std::vector<std::string> script_commands(const std::string& text) {
  std::vector<std::string> found;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t first = text.find_first_not_of(kBlank, begin);
    const bool remark = first != std::string::npos && text[first] == '#';
    const std::size_t end = std::min(text.find_first_of(remark ? "\n" : ";\n", begin), text.size());
    const std::string command = text.substr(begin, end - begin);
    if (!remark && command.find_first_not_of(kBlank) != std::string::npos) found.push_back(command);
    begin = end + 1;
  }
  return found;
}

}  // namespace bodyopt
