#include "viewport/commands/commands.h"

#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <sstream>

#include "shots/session/view_settings.h"
#include "tests/support/error_kind.h"
#include "tests/support/paths.h"

namespace bodyopt::testing {
namespace {

using namespace shots;
using namespace viewport;

// Frames 1 to 40 with keys, a range within, and names of joints and controls.
Controls controls_of_a_session() {
  Controls controls;
  controls.playback = Playback({1, 40}, 24);
  controls.playback.set_keys({5, 15});
  controls.playback.set_range(3, 30);
  controls.playback.scrub(10);
  controls.joint_names = {"Hips", "LeftArm", "LeftForeArm", "RightArm", "RightForeArm", "Bip01 L Arm"};
  controls.movable_names = {"Hips"};
  controls.copied = CopiedPose{{.joints = {{"LeftForeArm", {0, 0, 30}}}}, {"LeftForeArm"}};
  controls.recent = {"/shots/a.json", "/shots/b.json"};
  controls.recoverable = "/tmp/left.json";
  controls.axis_joints = {"LeftForeArm"};
  controls.joint_axes.assign(controls.joint_names.size(), Quat{0, 0, 0, 1});
  controls.live = false;
  controls.placements.resize(3);
  controls.cast_numbers = {1, 2, 3};
  controls.output_counts = {100, 50, 10};
  controls.marking.pairs = {{1, 2}};
  controls.control_names = {"biceps", "breath", "upper lip"};
  controls.axis_names = {"elbow_flexion"};
  controls.settings.pose.keys[5].joints["LeftArm"] = {0, 0, 0};
  controls.settings.pose.keys[10].joints["LeftArm"] = {4, 5, 6};
  controls.settings.pose.keys[20].joints["LeftArm"] = {40, 0, 0};
  controls.settings.shot_camera.keys[10].azimuth = 0.5;
  controls.file_cameras = {{"crane shot", 0.5, 0, {Affine()}}};
  controls.settings.cameras["close"] = {{1, 2, 3}, 0.5, 0.1, 0.2, true};
  controls.settings.pose.joints["Hips"] = {1, 2, 3};
  controls.settings.pose.joints["LeftArm"] = {4, 5, 6};
  controls.settings.pose.pins["LeftArm"] = {1, 2, 3};
  controls.poses.note(controls.settings);
  ViewSettings undone = controls.settings;
  undone.pose.joints["RightArm"] = {7, 8, 9};
  controls.poses.undo(undone);
  controls.joint = "LeftArm";
  controls.curating.regions = {"forearm", "upper arm"};
  controls.brush.kind = BrushKind::grab;
  controls.curating.frames = {"to 1", "to 4", "fro 1"};
  controls.curating.modifiers = {"elbow", "smooth all"};
  controls.curating.pairs = {{5, 12, "forearm"}, {7, 20, "upper arm"}};
  controls.curating.pair = 1;
  controls.camera.orbit(0.4, 0.2);
  return controls;
}

// What a command does with an argument that is right, and arguments that it refuses.
struct Case {
  std::string argument;
  bool (*done)(const Controls& before, const Controls& after);
  std::vector<std::string> refused{};
};

// Nothing where there is no such name.
template <typename Value>
std::optional<Value> valued(const std::map<std::string, Value>& values, const std::string& name) {
  const auto found = values.find(name);
  return found == values.end() ? std::nullopt : std::optional(found->second);
}

constexpr double kDegree = std::numbers::pi / 180;

bool looks_from(const Controls& controls, double azimuth, double elevation) {
  const OrbitView& view = controls.camera.view();
  return std::abs(view.azimuth - azimuth * kDegree) < 1e-12 && std::abs(view.elevation - elevation * kDegree) < 1e-12;
}

const std::map<std::string, Case>& cases() {
  using C = const Controls&;
  static const std::map<std::string, Case> all = {
      {"play", {"", [](C, C c) { return c.playback.playing(); }, {"fast"}}},
      {"step", {"3", [](C, C c) { return c.playback.frame() == 13; }, {"x", "1.5", "1 2", "99999999999"}}},
      {"step-back", {"", [](C, C c) { return c.playback.frame() == 9; }, {"2"}}},
      {"first", {"", [](C, C c) { return c.playback.frame() == 3; }, {"1"}}},
      {"last", {"", [](C, C c) { return c.playback.frame() == 30; }, {"1"}}},
      {"next-key", {"", [](C, C c) { return c.playback.frame() == 15; }, {"1"}}},
      {"previous-key", {"", [](C, C c) { return c.playback.frame() == 5; }, {"1"}}},
      {"frame", {"17", [](C, C c) { return c.playback.frame() == 17; }, {"", "seven", "1-2", "0x3", "0", "41", "to 2", "to"}}},
      {"backwards",
       {"on", [](C, C c) { return c.playback.backwards(); }, {"yes", "on off"}}},
      {"mode",
       {"ping-pong",
        [](C, C c) { return c.playback.mode() == PlayMode::ping_pong; },
        {"", "pingpong", "once loop"}}},
      {"speed",
       {"0.5",
        [](C, C c) { return c.playback.speed() == 0.5; },
        {"", "0.05", "2.1", "-1", "nan", "inf", "1x"}}},
      {"every-frame", {"on", [](C, C c) { return !c.playback.real_time(); }, {"1"}}},
      {"in",
       {"7",
        [](C, C c) { return c.playback.in() == 7 && c.playback.out() == 30; },
        {"x", "0", "41"}}},
      {"out",
       {"20",
        [](C, C c) { return c.playback.out() == 20 && c.playback.in() == 3; },
        {"x", "0", "41"}}},
      {"whole-range", {"", [](C, C c) { return c.playback.in() == 1 && c.playback.out() == 40; }, {"1"}}},
      {"sound",
       {"my take 2.wav 12",
        [](C, C c) { return c.requests.sound == SoundFile{"my take 2.wav", 12}; },
        {"a.mp3", "a.wav x", "a.mp3 3"}}},
      {"image-plane",
       {"a.####.png 0.5",
        [](C, C c) { return c.image_plane == ImagePlaneFile{"a.####.png", 0.5}; },
        {"a.tif", "absent.png", "a.####.png 1.5"}}},
      {"live", {"on", [](C, C c) { return c.live == true; }, {"yes"}}},
      {"frame-selection", {"", [](C, C c) { return c.requests.frame_selection; }, {"all"}}},
      {"front", {"", [](C, C c) { return looks_from(c, 0, 0); }, {"1"}}},
      {"back", {"", [](C, C c) { return looks_from(c, 180, 0); }, {"1"}}},
      {"right", {"", [](C, C c) { return looks_from(c, 90, 0); }, {"1"}}},
      {"left", {"", [](C, C c) { return looks_from(c, -90, 0); }, {"1"}}},
      {"top", {"", [](C, C c) { return looks_from(c, 0, 90); }, {"1"}}},
      {"bottom", {"", [](C, C c) { return looks_from(c, 0, -90); }, {"1"}}},
      {"cut-away", {"on", [](C, C c) { return c.camera.view().cut_away; }, {"yes"}}},
      {"orthographic",
       {"on", [](C, C c) { return c.camera.view().orthographic; }, {"yes"}}},
      {"follow", {"off", [](C, C c) { return !c.settings.look.follow; }, {"no"}}},
      {"orbit",
       {"10 -20",
        [](C b, C c) {
          return std::abs(c.camera.view().azimuth - b.camera.view().azimuth - 10 * kDegree) < 1e-9 &&
                 std::abs(c.camera.view().elevation - b.camera.view().elevation + 20 * kDegree) < 1e-9;
        },
        {"", "10", "10 20 30", "a b", "1e999 0"}}},
      {"orbit-left", {"", [](C b, C c) { return c.camera.view().azimuth < b.camera.view().azimuth; }, {"5"}}},
      {"orbit-right", {"", [](C b, C c) { return c.camera.view().azimuth > b.camera.view().azimuth; }, {"5"}}},
      {"dolly",
       {"2", [](C b, C c) { return c.camera.view().distance < b.camera.view().distance; }, {"", "near", "101"}}},
      {"save-camera",
       {"from the left", [](C, C c) { return valued(c.settings.cameras, "from the left") == c.camera.view(); }, {""}}},
      {"camera",
       {"close", [](C, C c) { return c.camera.view() == c.settings.cameras.at("close"); }, {"", "far", "close up"}}},
      {"forget-camera", {"close", [](C, C c) { return c.settings.cameras.empty(); }, {"", "far"}}},
      {"look-through",
       {"off", [](C, C c) { return !c.settings.shot_camera.look_through && !c.shot_frame; }, {"yes"}}},
      {"camera-key", {"", [](C, C c) { return c.settings.shot_camera.keys.at(10) == CameraKey{c.camera.view()}; }, {"1"}}},
      {"camera-unkey", {"", [](C, C c) { return c.settings.shot_camera.keys.empty(); }, {"1"}}},
      {"camera-ease",
       {"step", [](C, C c) { return c.settings.shot_camera.keys.at(10).ease == KeyEase::step; }, {"", "soft"}}},
      {"move-camera-key",
       {"10 12",
        [](C, C c) {
          const std::map<int, CameraKey>& keys = c.settings.shot_camera.keys;
          return keys.contains(12) && !keys.contains(10);
        },
        {"", "10", "11 12", "10 41", "10 x"}}},
      {"style", {"matcap", [](C, C c) { return c.settings.look.style == LookStyle::matcap; }, {"", "gold"}}},
      {"next-style", {"", [](C, C c) { return c.settings.look.style == LookStyle::matcap; }, {"1"}}},
      {"wire", {"on", [](C, C c) { return c.settings.look.wire; }, {"yes"}}},
      {"skeleton", {"on", [](C, C c) { return c.settings.look.skeleton; }, {"yes"}}},
      {"fibres", {"on", [](C, C c) { return c.settings.look.fibres; }, {"yes"}}},
      {"tets", {"on", [](C, C c) { return c.settings.look.tets; }, {"yes"}}},
      {"level", {"2", [](C, C c) { return c.settings.look.level == 2; }, {"", "finest", "-1", "1.5", "16"}}},
      {"tet-cut", {"0.25", [](C, C c) { return c.settings.look.tet_cut == 0.25; }, {"", "-0.1", "1.1"}}},
      {"anatomy", {"on", [](C, C c) { return c.settings.look.anatomy; }, {"yes"}}},
      {"anatomy-axis",
       {"x", [](C, C c) { return c.settings.look.anatomy_axis == SectionAxis::x; }, {"", "w", "0"}}},
      {"anatomy-at", {"0.25", [](C, C c) { return c.settings.look.anatomy_at == 0.25; }, {"", "-0.1", "1.1"}}},
      {"grid", {"off", [](C, C c) { return !c.settings.look.grid; }, {"no"}}},
      {"axes", {"off", [](C, C c) { return !c.settings.look.axes; }, {"no"}}},
      {"shadow", {"off", [](C, C c) { return !c.settings.look.shadow; }, {"no"}}},
      {"worn", {"off", [](C, C c) { return !c.settings.look.worn; }, {"no"}}},
      {"compare", {"ddm", [](C, C c) { return c.settings.compare.with == CompareWith::ddm; }, {"", "itself"}}},
      {"layout", {"wipe", [](C, C c) { return c.settings.compare.layout == CompareLayout::wipe; }, {"", "side"}}},
      {"next-layout", {"", [](C, C c) { return c.settings.compare.layout == CompareLayout::overlay; }, {"1"}}},
      {"wipe", {"0.25", [](C, C c) { return c.settings.compare.wipe == 0.25; }, {"", "-0.1", "1.1", "half"}}},
      {"heat", {"on", [](C, C c) { return c.settings.compare.heat; }, {"hot"}}},
      {"heat-scale", {"2.5", [](C, C c) { return c.settings.compare.heat_scale_mm == 2.5; }, {"", "0", "-1", "1001", "automatic"}}},
      {"activation", {"on", [](C, C c) { return c.settings.compare.activation; }, {"yes"}}},
      {"coverage", {"on", [](C, C c) { return c.settings.compare.coverage; }, {"yes"}}},
      {"match", {"colours", [](C, C c) { return c.settings.compare.match == MatchView::colours; }, {"", "on", "coloured"}}},
      {"worst-frame", {"", [](C, C c) { return c.requests.worst_frame; }, {"1"}}},
      {"worst-vertex", {"", [](C, C c) { return c.requests.worst_vertex; }, {"1"}}},
      {"mirror",
       {"LeftArm",
        [](C, C c) {
          return length(valued(c.settings.pose.joints, "RightArm").value_or(Vec3{}) - Vec3{4, -5, -6}) < 1e-9;
        },
        {"Hips", "Tail"}}},
      {"reset-joint", {"Hips", [](C, C c) { return !c.settings.pose.joints.contains("Hips"); }, {"Tail"}}},
      {"select", {"Hips", [](C, C c) { return c.joint == "Hips"; }, {"LeftArn", "Left Arm"}}},
      {"turn",
       {"LeftArm 10 -20 30",
        [](C, C c) {
          return valued(c.settings.pose.joints, "LeftArm") == Vec3{10, -20, 30};
        },
        {"", "LeftArm", "LeftArm 1 2", "LeftArm 1 2 361", "LeftArm 1 2 x", "Tail 1 2 3"}}},
      {"control",
       {"breath 0.5",
        [](C, C c) { return valued(c.settings.pose.controls, "breath") == 0.5; },
        {"", "breath", "breath x", "breath 1000001", "breathe 1"}}},
      {"axis",
       {"elbow_flexion 40",
        [](C, C c) { return valued(c.settings.pose.axes, "elbow_flexion") == 40; },
        {"", "elbow_flexion", "elbow_flexion x", "elbow_flexion 361", "knee_flexion 1"}}},
      {"key", {"", [](C, C c) { return c.settings.pose.keys.at(10) == c.settings.pose; }, {"1"}}},
      {"unkey", {"", [](C, C c) { return !c.settings.pose.keys.contains(10); }, {"1"}}},
      {"export-clip",
       {"take.bvh", [](C, C c) { return c.requests.export_clip == "take.bvh"; }, {"", "take.fbx", "take", "take.mdd"}}},
      {"export-skin",
       {"take.usda", [](C, C c) { return c.requests.export_skin == "take.usda"; }, {"", "take.abc", "take"}}},
      {"reset-pose",
       {"", [](C, C c) { return c.settings.pose.joints.empty() && c.settings.pose.controls.empty(); }, {"1"}}},
      {"undo", {"", [](C, C c) { return c.requests.step_back == true; }, {"1"}}},
      {"redo", {"", [](C, C c) { return c.requests.step_back == false; }, {"1"}}},
      {"correction", {"0.5", [](C, C c) { return c.settings.pose.correction == 0.5; }, {"", "1.01", "-0.01"}}},
      {"jiggle", {"on", [](C, C c) { return c.settings.jiggle.on; }, {"yes"}}},
      {"jiggle-amount", {"2", [](C, C c) { return c.settings.jiggle.amount == 2; }, {"", "4.1", "-1"}}},
      {"reset-jiggle", {"", [](C, C c) { return c.requests.reset_jiggle; }, {"1"}}},
      {"ghosts",
       {"3 1",
        [](C, C c) { return c.settings.ghosts.before == 3 && c.settings.ghosts.after == 1; },
        {"", "3", "13 0", "0 13", "-1 0", "a b", "1.5 1"}}},
      {"ghost-step", {"6", [](C, C c) { return c.settings.ghosts.step == 6; }, {"", "0", "1001", "x"}}},
      {"ghost-opacity", {"0.6", [](C, C c) { return c.settings.ghosts.opacity == 0.6; }, {"", "-0.1", "1.1", "x"}}},
      {"toggle-ghosts",
       {"on",
        [](C, C c) {
          return c.settings.ghosts.before == 2 && c.settings.ghosts.after == 2 && c.settings.ghosts.step == 4;
        },
        {"1"}}},
      {"trail", {"on", [](C, C c) { return c.settings.ghosts.trail; }, {"yes"}}},
      {"copies", {"12", [](C, C c) { return c.settings.cast.copies == 12; }, {"", "0", "1001", "1.5"}}},
      {"copy-delay", {"5", [](C, C c) { return c.settings.cast.delay == 5; }, {"", "-1", "1001"}}},
      {"mark", {"on", [](C, C c) { return c.marking.on; }, {"yes"}}},
      {"marker",
       {"99 49",
        [](C, C c) { return c.marking.pairs.back() == MarkedPair{99, 49}; },
        {"", "5", "5 x", "100 3", "3 50", "-1 3"}}},
      {"unmark", {"", [](C, C c) { return c.marking.pairs.empty(); }, {"1"}}},
      {"save-markers", {"m.json", [](C, C c) { return c.requests.save_markers == "m.json"; }, {"", "m.txt"}}},
      {"place",
       {"2 1 0 -2.5",
        [](C, C c) {
          return c.placements[1].at == Vec3{1, 0, -2.5};
        },
        {"", "2", "2 1 0", "2 1 0 far", "2 free", "1 0 0 0", "4 0 0 0", "hero auto"}}},
      {"ahead", {"3 -12", [](C, C c) { return c.placements[2].ahead == -12; }, {"", "3", "3 1.5", "1 4", "4 4", "3 100001"}}},
      {"level-of", {"2 1", [](C, C c) { return c.placements[1].level == 1; }, {"", "2", "2 16", "2 -1", "1 0", "4 0"}}},
      {"same-clip", {"", [](C, C c) { return c.requests.same_clip; }, {"on"}}},
      {"screenshot", {"a b.png", [](C, C c) { return c.requests.screenshot == "a b.png"; }}},
      {"turntable", {"t.####.png", [](C, C c) { return c.requests.turntable == "t.####.png"; }, {""}}},
      {"sequence", {"s.####.png", [](C, C c) { return c.requests.sequence == "s.####.png"; }, {""}}},
      {"browse", {"save", [](C, C c) { return c.dialog && c.dialog->command == "save"; }, {"", "play", "hats"}}},
      {"open", {"a.bvh", [](C, C c) { return c.requests.open == std::vector<std::string>{"a.bvh"}; }}},
      {"pan",
       {"0.5 -1",
        [](C b, C c) { return c.camera.view().target != b.camera.view().target; },
        {"", "1", "1 2 3", "left 0", "1000 0"}}},
      {"lead", {"2", [](C, C c) { return c.requests.lead == 2; }, {"", "hero", "1.5"}}},
      {"remove", {"3", [](C, C c) { return c.requests.remove == 3; }, {"", "hero", "1.5"}}},
      {"reload", {"", [](C, C c) { return c.requests.reload; }, {"1"}}},
      {"character", {"a.glb", [](C, C c) { return c.requests.add == std::vector<std::string>{"a.glb"}; }}},
      {"unit", {"0.01", [](C, C c) { return c.requests.unit == 0.01; }, {"", "0", "-1", "inches"}}},
      {"frame-range", {"", [](C, C c) { return c.requests.frame_range; }, {"1"}}},
      {"ease", {"step", [](C, C c) { return c.settings.pose.keys.at(10).ease == KeyEase::step; }, {"", "slow"}}},
      {"ease-joints",
       {"linear",
        [](C, C c) {
          return valued(c.settings.pose.keys.at(10).eases, "LeftArm") == KeyEase::linear &&
                 c.settings.pose.keys.at(10).ease == KeyEase::smooth;
        },
        {"", "slow"}}},
      {"shift-keys",
       {"2",
        [](C, C c) { return c.settings.pose.keys.contains(12) && !c.settings.pose.keys.contains(10); },
        {"", "x"}}},
      {"repeat-keys",
       {"8",
        [](C, C c) { return c.settings.pose.keys.contains(15) && c.settings.pose.keys.contains(10); },
        {"", "x"}}},
      {"scale-keys",
       {"0.5",
        [](C, C c) { return c.settings.pose.keys.contains(4) && c.settings.pose.keys.size() == 3; },
        {"", "0", "many"}}},
      {"limits", {"none", [](C, C c) { return c.requests.limits == "none"; }}},
      {"select-also",
       {"Hips", [](C, C c) { return c.joint == "LeftArm" && c.also.contains("Hips"); }, {"", "LeftArn"}}},
      {"copy", {"", [](C, C c) { return c.copied->pose.pins.contains("LeftArm") && c.copied->joints.empty(); }, {"1"}}},
      {"paste",
       {"",
        [](C, C c) {
          return valued(c.settings.pose.joints, "LeftForeArm") == Vec3{0, 0, 30} &&
                 c.settings.pose.joints.contains("LeftArm");
        },
        {"1"}}},
      {"paste-flipped", {"", [](C, C c) { return c.settings.pose.joints.contains("RightForeArm"); }, {"1"}}},
      {"flip-keys",
       {"",
        [](C, C c) {
          return length(valued(c.settings.pose.keys.at(10).joints, "RightArm").value_or(Vec3{}) - Vec3{4, -5, -6}) < 1e-9;
        },
        {"1"}}},
      {"tween",
       {"0.25",
        [](C, C c) {
          return length(valued(c.settings.pose.joints, "LeftArm").value_or(Vec3{}) - Vec3{10, 0, 0}) < 1e-9;
        },
        {"", "1.5", "half"}}},
      {"curves", {"on", [](C, C c) { return c.curves && c.dope_sheet; }, {"yes"}}},
      {"dope-sheet", {"on", [](C, C c) { return c.dope_sheet; }, {"yes"}}},
      {"zoom-range", {"on", [](C, C c) { return c.zooms; }, {"yes"}}},
      {"auto-key", {"on", [](C, C c) { return c.auto_key; }, {"yes"}}},
      {"save-pose", {"p.json", [](C, C c) { return c.requests.save_pose == "p.json"; }, {"", "p.txt"}}},
      {"load-pose",
       {"my p.json 0.5",
        [](C, C c) { return c.requests.load_pose == PoseRequest{"my p.json", 0.5}; },
        {"", "p.txt", "p.json 2", "p.txt 0.5"}}},
      {"recent", {"2", [](C, C c) { return c.requests.open == std::vector<std::string>{"/shots/b.json"}; }, {"", "0", "3"}}},
      {"recover", {"discard", [](C, C c) { return c.requests.recover == false; }, {"yes"}}},
      {"move",
       {"Hips 0.1 -0.2 0",
        [](C, C c) { return valued(c.settings.pose.moves, "Hips") == Vec3{0.1, -0.2, 0}; },
        {"", "Hips", "Hips 1 2", "LeftArm 0 0 1", "Hips 0 0 far", "Hips 0 0 1e9"}}},
      {"pin",
       {"LeftArm 1 2 -0.5",
        [](C, C c) {
          return c.requests.pin == PinRequest{"LeftArm", Vec3{1, 2, -0.5}};
        },
        {"nobody", "nobody 1 2 3", "LeftArm 1 2", "LeftArm 1 2 far"}}},
      {"unpin", {"LeftArm", [](C b, C c) { return b.settings.pose.pins.size() == 1 && c.settings.pose.pins.empty(); }, {"nobody"}}},
      {"move-key",
       {"10 4",
        [](C, C c) { return c.settings.pose.keys.contains(4) && !c.settings.pose.keys.contains(10); },
        {"", "3", "1 2", "10 1e9", "10 41"}}},
      {"save", {"s.json", [](C, C c) { return c.requests.save == "s.json"; }, {"s.txt"}}},
      {"save-state", {"s.json", [](C, C c) { return c.requests.save_state == "s.json"; }, {""}}},
      {"load-state", {"s.json", [](C, C c) { return c.requests.load_state == "s.json"; }, {""}}},
      {"panels", {"off", [](C, C c) { return !c.panels; }, {"no"}}},
      {"hud", {"off", [](C, C c) { return !c.settings.hud.on; }, {"no"}}},
      {"legend", {"off", [](C, C c) { return !c.settings.hud.legend; }, {"no"}}},
      {"cheat-sheet", {"on", [](C, C c) { return c.cheat_sheet; }, {"yes"}}},
      {"prompt", {"on", [](C, C c) { return c.prompt; }, {"yes"}}},
      {"side-panel", {"off", [](C, C c) { return !shows_side_panel(c.settings); }, {"no"}}},
      {"section",
       {"pose",
        [](C, C c) {
          return valued(c.settings.hud.panels, "pose") == true && valued(c.settings.hud.panels, "look") == false;
        },
        {"", "feet"}}},
      {"region", {"upper arm", [](C, C c) { return c.curating.region == "upper arm"; }, {"", "knee"}}},
      {"brush",
       {"smooth",
        [](C, C c) { return c.brush.kind == BrushKind::smooth && c.settings.compare.with == CompareWith::truth; },
        {"", "comb", "grab 3"}}},
      {"brush-radius", {"20", [](C, C c) { return c.brush.radius_mm == 20; }, {"", "0", "-5", "wide", "nan", "10001"}}},
      {"brush-strength", {"0.25", [](C, C c) { return c.brush.strength == 0.25; }, {"", "1.1", "-0.1", "nan"}}},
      {"brush-symmetry", {"on", [](C, C c) { return c.brush.symmetric; }, {"left"}}},
      {"brush-spread", {"45", [](C, C c) { return c.brush.spread == 45; }, {"", "361", "-1", "nan", "far"}}},
      {"brush-modifier", {"elbow fix", [](C, C c) { return c.brush.modifier == "elbow fix"; }, {""}}},
      {"stroke",
       {"0.25 0.5 1 0",
        [](C, C c) {
          return c.requests.stroke == PicturePath{{0.25, 0.5}, {1, 0}};
        },
        {"", "0.5", "0.5 0.5 0.5", "0.5 1.1", "a b", "nan 0.5"}}},
      {"keep-strokes", {"", [](C, C c) { return c.requests.keep_strokes; }, {"all"}}},
      {"map-colour", {"error", [](C, C c) { return c.curating.colour == MapColour::error; }, {"", "red"}}},
      {"raw", {"on", [](C, C c) { return c.curating.raw; }, {"maybe"}}},
      {"modifier",
       {"smooth all off",
        [](C, C c) { return c.requests.edits == std::vector<ModifierEdit>{{.name = "smooth all", .enabled = false}}; },
        {"", "elbow", "knee on", "elbow half"}}},
      {"strength",
       {"elbow 0.5",
        [](C, C c) { return c.requests.edits == std::vector<ModifierEdit>{{.name = "elbow", .strength = 0.5}}; },
        {"", "elbow", "knee 1", "elbow 2"}}},
      {"undo-edit", {"", [](C, C c) { return c.requests.step_back == true; }, {"twice"}}},
      {"redo-edit", {"", [](C, C c) { return c.requests.step_back == false; }, {"twice"}}},
      {"contradictions", {"", [](C, C c) { return c.requests.contradictions; }, {"all"}}},
      {"pair", {"2",
        [](C, C c) {
          return c.playback.frame() == 7 && c.curating.region == "upper arm" && c.requests.frame_selection;
        },
        {"", "0", "3", "two"}}},
      {"next-pair", {"", [](C, C c) { return c.curating.pair == 0 && c.playback.frame() == 5; }, {"back"}}},
      {"other-of-pair", {"", [](C, C c) { return c.playback.frame() == 7; }, {"first"}}},
      {"quit", {"", [](C, C c) { return c.requests.quit; }, {"now"}}},
      {"keymap",
       {"maya", [](C, C c) { return c.keymap == Keymap::maya && c.requests.keep_keymap; }, {"", "houdini"}}},
      {"move-tool", {"on", [](C, C c) { return c.tool == Tool::move; }, {"yes"}}},
      {"turn-tool", {"on", [](C, C c) { return c.tool == Tool::turn; }, {"yes"}}},
  };
  return all;
}

std::string message_of(Controls controls, const std::string& command) {
  try {
    run_command(controls, command);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::usage) << command;
    return error.what();
  }
  ADD_FAILURE() << "not refused: " << command;
  return {};
}

bool names_a_word(const std::string& message, const std::string& argument) {
  std::istringstream words(argument);
  for (std::string word; words >> word;) {
    if (message.find("'" + word) != std::string::npos) return true;
  }
  return false;
}

TEST(Commands, EachIsTriedHere) {
  for (const Command& command : commands()) EXPECT_TRUE(cases().contains(command.name)) << command.name;
}

TEST(Commands, DoWhatTheySay) {
  for (const auto& [name, c] : cases()) {
    if (!find_command(name)) continue;
    const Controls before = controls_of_a_session();
    Controls after = before;
    run_command(after, name + " " + c.argument);
    EXPECT_TRUE(c.done(before, after)) << name << " " << c.argument;
    EXPECT_FALSE(c.done(before, before)) << name << " changes nothing";
  }
}

TEST(Commands, UndoAndRedoAreOfThePoseWithoutABrush) {
  Controls controls = controls_of_a_session();
  run_command(controls, "brush none");
  EXPECT_FALSE(controls.brush.kind);
  run_command(controls, "undo");
  EXPECT_FALSE(controls.settings.pose.joints.contains("Hips"));
  run_command(controls, "redo");
  EXPECT_FALSE(controls.requests.step_back);
  EXPECT_TRUE(controls.settings.pose.joints.contains("Hips"));
}

TEST(Commands, APairNeedsContradictionsAndSaysWhereThereAreNone) {
  Controls controls = controls_of_a_session();
  controls.curating.pairs.clear();
  EXPECT_NE(message_of(controls, "pair 1").find("'contradictions' looks for them"), std::string::npos);
  controls.curating.compared = true;
  EXPECT_NE(message_of(controls, "pair 1").find("'contradictions' found no like poses"), std::string::npos);
}

TEST(Commands, BrushesNeedADatasetAndStrokesABrush) {
  Controls controls = controls_of_a_session();
  run_command(controls, "brush none");
  EXPECT_NE(message_of(controls, "stroke 0.5 0.5").find("no brush is in hand"), std::string::npos);
  controls.curating = {};
  EXPECT_NE(message_of(controls, "brush grab").find("bodyopt view DATASET"), std::string::npos);
}

TEST(Commands, RefuseWhatIsNoArgumentOfTheirsByName) {
  for (const auto& [name, c] : cases()) {
    if (!find_command(name)) continue;
    for (const std::string& argument : c.refused) {
      const std::string message = message_of(controls_of_a_session(), name + " " + argument);
      EXPECT_EQ(message.rfind(name + ": ", 0), 0u) << message;
      EXPECT_TRUE(argument.empty() ? message.size() > name.size() + 11 : names_a_word(message, argument)) << message;
    }
  }
}

// What a toggle sets is set twice by "on", and turned twice by no argument.
TEST(Commands, TogglesTurnRoundWithoutAnArgument) {
  int count = 0;
  for (const Command& command : commands()) {
    if (std::string(command.argument) != "[on|off]") continue;
    ++count;
    const Case& c = cases().at(command.name);
    const Controls before = controls_of_a_session();
    Controls controls = before;
    for (const bool changed : {true, false, true}) {
      run_command(controls, command.name);
      EXPECT_EQ(c.done(before, controls), changed) << command.name;
    }
    for (int k = 0; k < 2; ++k) {
      run_command(controls, command.name + std::string(" ") + c.argument);
      EXPECT_TRUE(c.done(before, controls)) << command.name;
    }
  }
  EXPECT_GT(count, 10);
}

// A key gives no argument; a menu asks for one that is needed.
TEST(Commands, InMenusAndOnKeysNeedNoArgument) {
  for (const Command& command : commands()) {
    const bool needs_argument = *command.argument != 0 && *command.argument != '[';
    EXPECT_FALSE(needs_argument && *command.key != 0) << command.name;
    if (needs_argument) continue;
    Controls controls = controls_of_a_session();
    EXPECT_NO_THROW(run_command(controls, command.name)) << command.name;
  }
}

// What a menu ticks.
TEST(Commands, ValueIsTheArgumentThatWasGiven) {
  int count = 0;
  for (const Command& command : commands()) {
    if (!command.value) continue;
    std::vector<std::string> arguments = choices_of(command);
    if (std::string(command.argument) == "[on|off]") arguments = {"on", "off"};
    Controls controls = controls_of_a_session();
    for (const std::string& argument : arguments) {
      run_command(controls, command.name + (" " + argument));
      EXPECT_EQ(command.value(controls), argument) << command.name;
      ++count;
    }
  }
  EXPECT_GT(count, 40);
}

// Frames that are solved follow each other in the viewport; their takes may have gaps.
TEST(Commands, AFrameIsNamedAsItsTakeNumbersIt) {
  Controls controls = controls_of_a_session();
  run_command(controls, "frame to 4");
  EXPECT_EQ(controls.playback.frame(), controls.playback.first() + 1);
  run_command(controls, "frame fro 1");
  EXPECT_EQ(controls.playback.frame(), controls.playback.first() + 2);
  EXPECT_NE(message_of(controls, "frame to 40").find("the nearest is 'to 4'"), std::string::npos);
  controls.curating.frames.clear();
  EXPECT_NE(message_of(controls, "frame to 4").find("there is none"), std::string::npos);
}

TEST(Commands, NamesAndKeysAreUniqueAndFound) {
  std::set<std::string> names;
  for (const Command& command : commands()) {
    EXPECT_TRUE(names.insert(command.name).second) << command.name;
    EXPECT_EQ(find_command(command.name), &command);
    EXPECT_GT(std::string(command.help).size(), 4u) << command.name;
  }
  for (const Keymap keymap : {Keymap::bodyopt, Keymap::maya, Keymap::blender}) {
    std::set<std::string> keys;
    for (const Command& command : commands()) {
      const std::string key = key_of(command, keymap);
      if (key.empty()) continue;
      EXPECT_TRUE(keys.insert(key).second) << key;
      EXPECT_EQ(find_command_by_key(key, keymap), &command);
      EXPECT_NE(key, "X") << "is held to flip";
    }
  }
  EXPECT_EQ(find_command("Play"), nullptr);
  EXPECT_EQ(find_command_by_key(""), nullptr);
  EXPECT_EQ(find_command_by_key("Ctrl+Alt+Q"), nullptr);
}

TEST(Commands, KeysAreThoseOfTheProgramThatIsChosen) {
  const auto name_of_key = [](const char* key, Keymap keymap) {
    const Command* found = find_command_by_key(key, keymap);
    return std::string(found ? found->name : "");
  };
  const std::array<std::array<std::string, 4>, 9> expected = {{{"W", "wire", "move-tool", ""},
                                                               {"E", "heat", "turn-tool", "heat"},
                                                               {"R", "reset-joint", "", "turn-tool"},
                                                               {"G", "toggle-ghosts", "toggle-ghosts", "move-tool"},
                                                               {"4", "", "wire", "orbit-left"},
                                                               {"S", "next-style", "key", ""},
                                                               {"I", "in", "in", "key"},
                                                               {"Home", "first", "first", "frame-range"},
                                                               {"Ctrl+S", "save", "save", "save"}}};
  for (const auto& [key, own, in_maya, in_blender] : expected) {
    EXPECT_EQ(name_of_key(key.c_str(), Keymap::bodyopt), own) << key;
    EXPECT_EQ(name_of_key(key.c_str(), Keymap::maya), in_maya) << key;
    EXPECT_EQ(name_of_key(key.c_str(), Keymap::blender), in_blender) << key;
  }
}

TEST(Commands, NearestNameIsProposed) {
  const Controls controls = controls_of_a_session();
  for (const auto& [wrong, right] : std::map<std::string, std::string>{
           {"plya", "play"}, {"skeletn on", "skeleton"}, {"Frame 3", "frame"}, {"heatscale 3", "heat-scale"}}) {
    EXPECT_NE(message_of(controls, wrong).find("the nearest is '" + right + "'"), std::string::npos) << wrong;
  }
  EXPECT_NE(message_of(controls, "select LeftForeArn").find("'LeftForeArm'"), std::string::npos);
  EXPECT_NE(message_of(controls, "control breathe 1").find("'breath'"), std::string::npos);
  EXPECT_NE(message_of({}, "control breath 1").find("there is none"), std::string::npos);
}

TEST(Commands, BlanksAroundThemDoNotCount) {
  Controls controls = controls_of_a_session();
  run_command(controls, " \tstyle   flat \r");
  EXPECT_EQ(controls.settings.look.style, LookStyle::flat);
  run_command(controls, "turn  Hips  1 2\t3");
  EXPECT_EQ(controls.settings.pose.joints.at("Hips"), (Vec3{1, 2, 3}));
}

TEST(Commands, NamesMayHoldBlanks) {
  Controls controls = controls_of_a_session();
  run_command(controls, "turn Bip01 L Arm 1 -2 3.5");
  EXPECT_EQ(controls.settings.pose.joints.at("Bip01 L Arm"), (Vec3{1, -2, 3.5}));
  run_command(controls, "select Bip01 L Arm");
  EXPECT_EQ(controls.joint, "Bip01 L Arm");
  run_command(controls, "control upper lip 0.25");
  EXPECT_EQ(controls.settings.pose.controls.at("upper lip"), 0.25);
}

TEST(Commands, OfKeysSayThatThereAreNone) {
  Controls controls = controls_of_a_session();
  controls.playback.set_keys({});
  controls.settings.pose.keys.clear();
  controls.settings.shot_camera.keys.clear();
  for (const char* command : {"next-key", "previous-key"}) {
    EXPECT_NE(message_of(controls, command).find("no keys"), std::string::npos);
  }
  // Those that were set are gone to as the clip's are.
  const int first = controls.playback.first();
  controls.settings.pose.keys[first + 3] = {};
  controls.settings.shot_camera.keys[first + 5] = {};
  run_command(controls, "frame " + std::to_string(first));
  for (const int frame : {first + 3, first + 5, first + 5}) {
    run_command(controls, "next-key");
    EXPECT_EQ(controls.playback.frame(), frame);
  }
  run_command(controls, "previous-key");
  EXPECT_EQ(controls.playback.frame(), first + 3);
}

TEST(Commands, BackwardsTurnsRoundWhateverWayAPingPongGoes) {
  Controls controls = controls_of_a_session();
  run_command(controls, "mode ping-pong");
  controls.playback.play();
  controls.playback.set_range(10, 12);
  for (int k = 0; k < 3; ++k) controls.playback.advance(1.0 / 24);
  EXPECT_TRUE(controls.playback.backwards());
  run_command(controls, "backwards");
  EXPECT_FALSE(controls.playback.backwards());
  EXPECT_EQ(find_command("backwards")->value(controls), "off");
}

TEST(Commands, LiveNeedsAPort) {
  Controls controls = controls_of_a_session();
  controls.live.reset();
  EXPECT_NE(message_of(controls, "live on").find("--live"), std::string::npos);
}

// Held keys go on and on; what turns round, writes or opens happens once.
TEST(Commands, ThatRepeatGoStepByStep) {
  std::set<std::string> repeating;
  for (const Command& command : commands()) {
    if (command.repeats) repeating.insert(command.name);
  }
  EXPECT_EQ(repeating,
            (std::set<std::string>{"step", "step-back", "next-key", "previous-key", "orbit-left", "orbit-right"}));
}

// docs/view.md has a row for every command, in the table's order, and no other.
TEST(Commands, AreThoseOfTheDocs) {
  std::vector<std::string> expected, found;
  for (const Command& command : commands()) {
    std::string call = command.name + std::string(*command.argument ? " " : "") + command.argument;
    for (std::size_t at = 0; (at = call.find('|', at)) != std::string::npos; at += 2) call.insert(at, "\\");
    expected.push_back("| `" + call + "` | " + command.key + " | " + command.menu + " | " + command.help + " |");
  }
  std::ifstream page(kSourceFolder + "/docs/view.md");
  std::string line;
  while (std::getline(page, line) && line != "| command | key | menu | does |") continue;
  std::getline(page, line);
  while (std::getline(page, line) && !line.empty()) found.push_back(line);
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t k = 0; k < found.size(); ++k) EXPECT_EQ(found[k], expected[k]);
}

TEST(Commands, ScriptsArePartedBySemicolonsAndLineEnds) {
  using Commands = std::vector<std::string>;
  EXPECT_EQ(script_commands("frame 12;style flat\nplay"), (Commands{"frame 12", "style flat", "play"}));
  EXPECT_EQ(script_commands(";; \r\n ;play;\n\n"), (Commands{"play"}));
  EXPECT_EQ(script_commands("# a remark; play\nfront # not one"), (Commands{"front # not one"}));
  EXPECT_EQ(script_commands("play; # the rest; too"), (Commands{"play"}));
  EXPECT_EQ(script_commands("sequence a.####.png"), (Commands{"sequence a.####.png"}));
  EXPECT_EQ(script_commands(""), Commands());
  EXPECT_EQ(script_commands("#"), Commands());
}

}  // namespace
}  // namespace bodyopt::testing
