// A pose that is kept: keys, undo, what is exported, and what eval then gives.
#include <gtest/gtest.h>

#include <fstream>

#include "assets/clips/controls.h"
#include "assets/clips/shot_modifiers.h"
#include "runtime/basis/character_unit.h"
#include "shots/session/posed_clip.h"
#include "tests/support/breathing.h"
#include "tests/support/error_kind.h"
#include "tests/support/gpu_fixture.h"
#include "tests/support/random_tables.h"
#include "tests/viewport/small_character.h"
#include "viewport/commands/commands.h"
#include "viewport/session.h"
#include "viewport/work_files.h"

namespace bodyopt::testing {
namespace pose_keys_test {

using namespace trainer;
using namespace shots;
using namespace viewport;

ViewSettings::PoseKey bent(double degrees) {
  ViewSettings::PoseKey key;
  key.joints["upper"] = {degrees, 0, 0};
  return key;
}

TEST(PoseKeys, BlendBetweenKeysAndHoldBeyond) {
  std::map<int, ViewSettings::PoseKey> keys = {{10, bent(0)}, {20, bent(40)}};
  keys[20].controls["breath"] = 0.5;
  keys[20].axes["bend"] = 8;
  EXPECT_EQ(between_keys(keys, 5), keys[10]);
  EXPECT_EQ(between_keys(keys, 20), keys[20]);
  EXPECT_EQ(between_keys(keys, 99), keys[20]);
  const ViewSettings::PoseKey middle = between_keys(keys, 15);
  EXPECT_DOUBLE_EQ(middle.joints.at("upper")[0], 20);
  EXPECT_DOUBLE_EQ(middle.axes.at("bend"), 4);
  EXPECT_DOUBLE_EQ(middle.controls.at("breath"), 0.5);                // as the other key has it
  EXPECT_LT(between_keys(keys, 12).joints.at("upper")[0], 0.2 * 40);  // slow at the key
}

// Played, scrubbed, or after another key: a frame is the one of the clip that is exported.
TEST(PoseKeys, FramesAreThoseOfTheWholeClipInAnyOrder) {
  Basis basis = small_basis();
  add_breathing(basis).constants["depth"] = 1;
  Clip clip = bending_clip(basis.skeleton);
  for (std::size_t k = 0; clip.poses.size() < 150; ++k) clip.poses.push_back(clip.poses[k]);
  ViewSettings::Posing posing;
  ModifierTrack track;
  const auto expect_same = [&](std::initializer_list<std::size_t> frames) {
    Clip whole = posed_clip(clip, basis.skeleton, {}, posing);
    apply_channels(basis, whole);
    for (const std::size_t k : frames) {
      const ViewSettings::Posing here = keyed_posing(posing, clip.first_frame + static_cast<int>(k));
      const Pose pose = posed_frame(clip, k, basis, {}, here, track);
      EXPECT_TRUE(same({&pose, 1}, {&whole.poses[k], 1})) << k;
    }
    return whole.poses.back().modifiers;
  };
  const std::vector<float> plain = expect_same({0, 9, 3, 149, 148, 70});
  posing.controls["breath.rate"] = 45;
  const std::vector<float> fast = expect_same({149, 5});
  EXPECT_NE(fast, plain);
  posing.keys[clip.first_frame + 2].controls["breath.rate"] = 10;
  posing.keys[clip.first_frame + 8].controls["breath.rate"] = 60;
  const std::vector<float> keyed = expect_same({4, 149, 7});
  EXPECT_NE(keyed, fast);
  posing.keys[clip.first_frame + 2].controls["breath.rate"] = 40;
  EXPECT_NE(expect_same({149, 1}), keyed);
}

TEST(PoseKeys, EaseToTheNextAsTheySay) {
  std::map<int, ViewSettings::PoseKey> keys = {{10, bent(0)}, {20, bent(40)}};
  keys[10].ease = KeyEase::linear;
  EXPECT_DOUBLE_EQ(between_keys(keys, 12).joints.at("upper")[0], 8);
  keys[10].ease = KeyEase::step;
  EXPECT_DOUBLE_EQ(between_keys(keys, 19).joints.at("upper")[0], 0);
  EXPECT_DOUBLE_EQ(between_keys(keys, 20).joints.at("upper")[0], 40);
  keys[20].pins["foot"] = {1, 2, 3};
  EXPECT_EQ(between_keys(keys, 19), keys[10]) << "nor is a pin of the next held before";
  EXPECT_TRUE(blended(keys[10], keys[20], 0).pins.empty());
  EXPECT_EQ(blended(keys[20], keys[10], 1), keys[10]) << "nor one of the key before when that is over";
}

// A joint, an axis, a control by itself; the rest as the key says.
TEST(PoseKeys, EaseOfEachMayBeItsOwn) {
  std::map<int, ViewSettings::PoseKey> keys = {{10, bent(0)}, {20, bent(40)}};
  keys[10].joints["lower"] = {0, 0, 0};
  keys[20].joints["lower"] = {0, 10, 0};
  keys[10].eases = {{"upper", KeyEase::linear}, {"foot", KeyEase::step}, {"breath", KeyEase::step}};
  keys[20].pins["foot"] = keys[20].facing["foot"] = keys[20].moves["foot"] = {1, 2, 3};
  keys[10].controls["breath"] = 0.25;
  keys[20].controls["breath"] = 0.75;
  const ViewSettings::PoseKey at = between_keys(keys, 12);
  EXPECT_DOUBLE_EQ(at.joints.at("upper")[0], 8);
  EXPECT_DOUBLE_EQ(at.joints.at("lower")[1], 10 * 0.2 * 0.2 * (3 - 0.4));
  EXPECT_EQ(at.controls.at("breath"), 0.25);
  EXPECT_TRUE(at.pins.empty() && at.facing.empty() && at.moves.empty());
  EXPECT_EQ(at.eases, keys[10].eases);
  EXPECT_EQ(between_keys(keys, 20), keys[20]);
}

// One tangent through a key, flat where the way turns, no further than the keys.
TEST(PoseKeys, OfASplineHaveOneTangentAndGoNoFurther) {
  std::map<int, ViewSettings::PoseKey> keys = {
      {0, bent(0)}, {10, bent(10)}, {30, bent(60)}, {40, bent(60)}, {50, bent(20)}};
  for (auto& [frame, key] : keys) {
    key.ease = KeyEase::spline;
    key.axes["bend"] = key.pins["foot"][1] = key.joints["upper"][0];
    key.facing["foot"] = {0, key.joints["upper"][0], 0};
  }
  // By shares of a frame: the slopes right before and right after a key.
  const auto value = [&](const ViewSettings::PoseKey& key) { return key.joints.at("upper")[0]; };
  const auto slopes = [&](int frame) {
    constexpr int kFine = 1000;
    std::map<int, ViewSettings::PoseKey> fine;
    for (const auto& [at, key] : keys) fine[kFine * at] = key;
    const double here = value(between_keys(fine, kFine * frame));
    return std::pair(kFine * (here - value(between_keys(fine, kFine * frame - 1))),
                     kFine * (value(between_keys(fine, kFine * frame + 1)) - here));
  };
  const auto expect_one_tangent = [&](int frame, double slope) {
    const auto [before, after] = slopes(frame);
    EXPECT_NEAR(before, after, 0.01) << frame;
    EXPECT_NEAR(after, slope, 0.01) << frame;
  };
  expect_one_tangent(10, 2 * 1 * 2.5 / (1 + 2.5));
  expect_one_tangent(30, 0);
  expect_one_tangent(40, 0);
  double before = 0;
  for (int frame = 0; frame <= 50; ++frame) {
    const ViewSettings::PoseKey at = between_keys(keys, frame);
    if (frame <= 40) {
      EXPECT_GE(value(at), before) << frame;
    }
    EXPECT_LE(value(at), 60);
    EXPECT_NEAR(at.axes.at("bend"), value(at), 1e-9);
    EXPECT_NEAR(at.pins.at("foot")[1], value(at), 1e-9);
    EXPECT_NEAR(at.facing.at("foot")[1], value(at), 1e-6);
    before = value(at);
  }
  // It goes on from a straight line, and rests where that on the other side rests.
  keys[10].ease = KeyEase::linear;
  EXPECT_NEAR(slopes(10).first, 2.5, 0.01);
  keys[10].ease = KeyEase::smooth;
  expect_one_tangent(10, 0);
  keys[10].ease = KeyEase::step;
  EXPECT_NEAR(slopes(10).first, 0, 0.01);
  // One that is smooth is so whatever is around it.
  keys = {{0, bent(0)}, {10, bent(10)}};
  const ViewSettings::PoseKey alone = between_keys(keys, 3);
  keys[12] = bent(50);
  EXPECT_EQ(between_keys(keys, 3), alone);
}

// The short way about, whatever the angles that name it.
TEST(PoseKeys, BlendHowAFootFacesByTheShortestTurn) {
  std::map<int, ViewSettings::PoseKey> keys;
  keys[0].facing["foot"] = {0, 170, 0};
  keys[10].facing["foot"] = {0, -170, 0};
  const Quat middle = turn_of(between_keys(keys, 5).facing.at("foot"));
  EXPECT_NEAR(angle_between(middle, turn_of({0, 180, 0})), 0, 1e-6);
}

// Of a body whose sides are each other's mirror image.
class FlippedPoseTest : public ::testing::Test {
 protected:
  FlippedPoseTest() {
    controls_.joint_names = {"Spine", "LeftArm", "RightArm"};
    controls_.joint_axes = {Quat{0, 0, 0, 1}, axis_angle({0, 0, 1}, 0.7), axis_angle({0, 0, 1}, -0.7)};
    controls_.axis_names = {"left_shoulder_abduction", "right_shoulder_abduction", "spine_flexion", "spine_rotation"};
    controls_.axis_joints = {"LeftArm", "RightArm", "Spine", "Spine"};
    controls_.axes_flip = {true, true, false, true};
    controls_.control_names = {"left_biceps", "right_biceps", "breath"};
    pose().joints = {{"LeftArm", {10, 20, 30}}, {"Spine", {5, 6, 7}}};
    pose().axes = {{"left_shoulder_abduction", 40}, {"spine_flexion", 12}, {"spine_rotation", 9}};
    pose().controls = {{"left_biceps", 0.5}, {"breath", 0.25}};
    pose().pins = {{"LeftArm", {0.5, 1, 0.2}}};
    pose().facing = {{"LeftArm", {0, 30, 40}}};
    pose().moves = {{"Spine", {0.1, -0.2, 0.3}}};
    pose().eases = {{"LeftArm", KeyEase::step}, {"left_biceps", KeyEase::linear}, {"spine_flexion", KeyEase::linear}};
  }
  ViewSettings::Posing& pose() { return controls_.settings.pose; }
  void run(const std::string& command) { run_command(controls_, command); }

  Controls controls_;
};

TEST_F(FlippedPoseTest, ExchangesTheSidesAndTwiceIsAsItWas) {
  const ViewSettings::Posing before = pose();
  run("copy");
  run("paste-flipped");
  EXPECT_FALSE(pose().joints.contains("LeftArm"));
  EXPECT_LT(length(pose().joints.at("Spine") - Vec3{5, -6, -7}), 1e-9);
  EXPECT_EQ(pose().axes.at("right_shoulder_abduction"), 40);
  EXPECT_EQ(pose().axes.at("spine_flexion"), 12) << "to the front is to the front";
  EXPECT_EQ(pose().axes.at("spine_rotation"), -9);
  EXPECT_EQ(pose().controls.at("right_biceps"), 0.5);
  EXPECT_EQ(pose().controls.at("breath"), 0.25);
  EXPECT_EQ(pose().pins.at("RightArm"), (Vec3{-0.5, 1, 0.2}));
  EXPECT_EQ(pose().moves.at("Spine"), (Vec3{-0.1, -0.2, 0.3}));
  run("copy");
  run("paste-flipped");
  EXPECT_LT(length(pose().joints.at("LeftArm") - before.joints.at("LeftArm")), 1e-6);
  EXPECT_NEAR(angle_between(turn_of(pose().facing.at("LeftArm")), turn_of(before.facing.at("LeftArm"))), 0, 1e-6);
  EXPECT_EQ(pose().axes, before.axes);
}

TEST_F(FlippedPoseTest, IsMirroredWhereTheRootStands) {
  controls_.playback = Playback({1, 100}, 24);
  controls_.root_x = [](int frame) { return 0.1 * frame; };
  controls_.playback.scrub(20);
  run("copy");
  run("paste-flipped");
  EXPECT_NEAR(pose().pins.at("RightArm")[0], 3.5, 1e-12);
  pose().keys[50].pins["LeftArm"] = {5.25, 1, 0.2};
  pose().keys[50].eases = pose().eases;
  run("flip-keys");
  EXPECT_EQ(pose().keys[50].eases,
            (std::map<std::string, KeyEase>{
                {"RightArm", KeyEase::step}, {"right_biceps", KeyEase::linear}, {"spine_flexion", KeyEase::linear}}));
  EXPECT_NEAR(pose().keys[50].pins.at("RightArm")[0], 4.75, 1e-12);
}

TEST_F(FlippedPoseTest, AutoKeyKeepsAPoseThatIsLeftBeforeAPictureIsDrawn) {
  controls_.playback = Playback({1, 100}, 24);
  controls_.playback.scrub(10);
  controls_.follow_keys();
  run("auto-key on");
  pose().joints["Spine"] = {1, 2, 3};
  controls_.playback.scrub(30);
  controls_.follow_keys();
  EXPECT_EQ(pose().keys.at(10).joints.at("Spine"), (Vec3{1, 2, 3}));
  EXPECT_EQ(pose().keys.size(), 1u);
}

TEST_F(FlippedPoseTest, OfSeveralJointsLeavesTheOthers) {
  run("select LeftArm");
  run("select-also Spine");
  EXPECT_EQ(controls_.selected(), (std::vector<std::string>{"LeftArm", "Spine"}));
  run("copy");
  EXPECT_TRUE(controls_.copied->pose.controls.empty()) << "controls are of no joint";
  run("reset-pose");
  pose().joints["RightArm"] = {1, 2, 3};
  pose().controls["breath"] = 0.75;
  run("paste");
  EXPECT_EQ(pose().joints.at("LeftArm"), (Vec3{10, 20, 30}));
  EXPECT_EQ(pose().axes.at("spine_flexion"), 12);
  EXPECT_EQ(pose().joints.at("RightArm"), (Vec3{1, 2, 3}));
  EXPECT_EQ(pose().controls.at("breath"), 0.75);
  run("reset-joint");
  EXPECT_EQ(pose().joints.size(), 1u);
  EXPECT_TRUE(pose().axes.empty()) << "sliders of the limits, too";
  run("select-also LeftArm");
  EXPECT_EQ(controls_.joint, "Spine");
  run("select-also Spine");
  EXPECT_EQ(controls_.joint, "");
}

TEST_F(FlippedPoseTest, MirrorTakesTheSlidersOfTheLimitsAlong) {
  run("mirror LeftArm");
  EXPECT_EQ(pose().axes.at("right_shoulder_abduction"), 40);
  EXPECT_EQ(pose().axes.at("left_shoulder_abduction"), 40);
  EXPECT_TRUE(pose().pins.contains("RightArm"));
  EXPECT_EQ(kind_of([&] { run("mirror Spine"); }), ErrorKind::usage);
}

TEST_F(FlippedPoseTest, KeysOfTheRangeAreShiftedRepeatedAndScaled) {
  controls_.playback = Playback({1, 100}, 24);
  controls_.playback.set_range(10, 30);
  const auto frames = [&] {
    std::vector<int> all;
    for (const auto& [frame, key] : pose().keys) all.push_back(frame);
    return all;
  };
  const auto begin = [&] {
    pose().keys.clear();
    for (const int frame : {5, 10, 20, 40}) pose().keys[frame].joints["LeftArm"] = {static_cast<double>(frame), 0, 0};
  };
  begin();
  run("shift-keys 20");
  EXPECT_EQ(frames(), (std::vector{5, 30, 40}));
  EXPECT_EQ(pose().keys[40].joints["LeftArm"][0], 20) << "what was there gives way";
  begin();
  run("repeat-keys 50");
  EXPECT_EQ(frames(), (std::vector{5, 10, 20, 40, 50, 60}));
  begin();
  run("scale-keys 0.5");
  EXPECT_EQ(frames(), (std::vector{5, 10, 15, 40}));
  EXPECT_EQ(controls_.messages.size(), 1u);  // of the shift
  run("scale-keys 0.01");
  EXPECT_EQ(frames(), (std::vector{5, 10, 40}));
  EXPECT_EQ(controls_.messages.back().text, "1 of the keys gave way to others of their frames");
  begin();
  EXPECT_EQ(kind_of([&] { run("shift-keys 90"); }), ErrorKind::usage) << "no such frame";
  EXPECT_EQ(frames(), (std::vector{5, 10, 20, 40}));
  run("flip-keys");
  EXPECT_TRUE(pose().keys[10].joints.contains("RightArm"));
  EXPECT_TRUE(pose().keys[40].joints.contains("LeftArm")) << "it is not of the range";
}

TEST_F(FlippedPoseTest, TweensBetweenTheKeysAround) {
  controls_.playback = Playback({1, 100}, 24);
  pose().keys[10].joints["LeftArm"] = {0, 0, 0};
  pose().keys[20].joints["LeftArm"] = {40, 0, 0};
  controls_.playback.scrub(12);
  run("tween 0.75");
  EXPECT_DOUBLE_EQ(pose().joints.at("LeftArm")[0], 30);
  controls_.playback.scrub(20);
  EXPECT_EQ(kind_of([&] { run("tween 0.5"); }), ErrorKind::usage);
}

// The small character with a modifier that breathes by its two components, its joint limits, and a session over it.
class KeptPoseTest : public ::testing::Test {
 protected:
  static Basis breathing(Basis basis) {
    Random random(3);
    SkinModifier& modifier = basis.modifiers.stack.emplace_back();
    modifier.name = "air";
    modifier.type = "breathing";
    modifier.component_count = 2;
    modifier.numbers = {1};
    modifier.turns = {{1, 0, 0.3f, 0, 0}};
    modifier.constants = {{"rate", 60}};
    basis.modifiers.blend_begin.push_back(0);
    for (std::uint32_t first = 0; first < basis.mesh.vertex_count(); first += kBlockSize) {
      const std::uint32_t lanes = std::min(kBlockSize, basis.mesh.vertex_count() - first);
      for (std::uint32_t k = 0; k < 2; ++k) basis.modifiers.blend.push_back(random_blend_entry(random, 0.02, k, lanes));
      basis.modifiers.blend_begin.push_back(static_cast<std::uint32_t>(basis.modifiers.blend.size()));
    }
    return basis;
  }

  void SetUp() override {
    std::ofstream(folder_ / "limits.json") << R"({"schema": "bodyopt-joint-limits-1", "dofs": [
      {"name": "bend_forward", "rest": 0, "min": -90, "max": 90,
       "turns": [{"joint": "upper", "axis": [1, 0, 0]}]}]})";
    save_basis(breathing(small_.made), small_.basis);
    session_.open_first();
    session_.open(small_.clip);
    session_.play_clip();
  }
  Controls& controls() { return session_.controls; }
  void run(const std::string& script) {
    for (const std::string& command : script_commands(script)) {
      controls().follow_keys();
      run_command(controls(), command);
      controls().follow_keys();
      controls().poses.note(controls().settings);
    }
  }
  Pose shown() { return session_.scene.lead_pose(controls()); }

  TemporaryFolder folder_;
  SmallCharacter small_{folder_};
  const ViewerOptions options_ = [this] {
    ViewerOptions options;
    options.files = {small_.basis};
    options.limits = (folder_ / "limits.json").string();
    return options;
  }();
  Session session_{open_test_device(), options_};
};

TEST_F(KeptPoseTest, KeysAreShownAndUndone) {
  run("frame 2; turn upper 30 0 0; key; frame 10; turn upper 0 0 50; control air 0; key; frame 6");
  const ViewSettings::Posing middle = controls().settings.pose;
  EXPECT_DOUBLE_EQ(middle.joints.at("upper")[0], 15);
  EXPECT_DOUBLE_EQ(middle.joints.at("upper")[2], 25);
  EXPECT_EQ(middle.keys.size(), 2u);
  run("frame 2");
  EXPECT_DOUBLE_EQ(controls().settings.pose.joints.at("upper")[0], 30);
  run("frame 5; unkey");  // which says that there is none
  EXPECT_EQ(controls().settings.pose.keys.size(), 2u);
  run("frame 10; unkey");
  EXPECT_EQ(controls().settings.pose.keys.size(), 1u);
  run("undo");
  EXPECT_EQ(controls().settings.pose.keys.size(), 2u);
  session_.save_state((folder_ / "state.json").string());
  const ViewSettings::Posing kept = controls().settings.pose;
  run("reset-pose");
  session_.load_state((folder_ / "state.json").string());
  EXPECT_EQ(controls().settings.pose, kept);
}

TEST_F(KeptPoseTest, AnAxisTurnsAboutTheWorldsAxisAtRest) {
  const Pose before = shown();
  run("axis bend_forward 25");
  const Quat parent = axis_angle({0, 1, 0}, 0.4);  // of the lower joint in the bind pose
  const Quat expected =
      axis_angle(rotate(conjugate(parent), {1, 0, 0}), 25 * std::acos(-1.0) / 180) * before.joints[1].rotation;
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(shown().joints[1].rotation[i], expected[i], 1e-9);
  EXPECT_EQ(kind_of([&] { run("axis bend_backward 3"); }), ErrorKind::usage);
}

TEST_F(KeptPoseTest, WhatIsExportedEvaluatesToWhatWasSeen) {
  run("frame 2; turn upper 30 0 0; key; frame 9; control air.depth 1.5; control breath 0.5; axis bend_forward 10; key");
  export_clip(session_.scene, session_.controls, (folder_ / "posed.glb").string());
  export_skin(session_.scene, session_.controls, (folder_ / "posed.pc2").string());
  const Basis basis = load_basis(small_.basis);
  ClipOptions options;
  options.controls = (folder_ / "posed.controls.json").string();
  Clip clip = read_clip((folder_ / "posed.glb").string(), basis.skeleton, options);
  ASSERT_EQ(clip.poses.size(), static_cast<std::size_t>(kClipFrames));
  EXPECT_TRUE(apply_channels(basis, clip).empty());
  const Evaluation evaluation = Deformer(basis, DeviceChoice{.name = "cpu"}).evaluate(clip.poses);
  const Pc2Reader skin(folder_ / "posed.pc2");
  const std::size_t numbers = 3 * basis.mesh.output_count();
  float largest = 0;
  for (std::uint32_t k = 0; k < clip.poses.size(); ++k) {
    const std::vector<float> seen = skin.sample(k);
    for (std::size_t i = 0; i < numbers; ++i) {
      largest = std::max(largest, std::abs(seen[i] - evaluation.positions[k * numbers + i]));
    }
  }
  EXPECT_LT(largest, 2e-5f);  // metres, of a body 1.1 m tall: rotations are single in a glTF
  // And the modifier is seen: without it the skin is another.
  run("control air 0; key");
  export_skin(session_.scene, session_.controls, (folder_ / "still.pc2").string());
  EXPECT_NE(Pc2Reader(folder_ / "still.pc2").sample(8), skin.sample(8));
}

// A file of a character in centimetres, and its clips.
TEST_F(KeptPoseTest, AnExportedClipIsInTheUnitOfItsCharacter) {
  constexpr double kUnit = 0.01;
  Basis basis = load_basis(small_.basis);
  keep_unit(basis, kUnit);
  const std::string file = (folder_ / "centimetres.safetensors").string(), own = (folder_ / "own.glb").string();
  save_basis(basis, file);
  write_clip(bending_clip(basis.skeleton), basis.skeleton, kUnit, own);
  ViewerOptions options;
  options.files = {file};
  Session session{open_test_device(), options};
  session.open_first();
  session.open(own);
  session.play_clip();
  for (const char* written : {"again.glb", "again.bvh"}) {
    const std::string again = (folder_ / written).string();
    export_clip(session.scene, session.controls, again);
    const Clip meant = read_clip(own, basis.skeleton, {.unit = kUnit}),
               found = read_clip(again, basis.skeleton, {.unit = clip_unit(again, kUnit)});
    ASSERT_EQ(found.poses.size(), meant.poses.size());
    for (std::size_t k = 0; k < meant.poses.size(); ++k) {
      const Vec3 a = meant.poses[k].joints[0].translation, b = found.poses[k].joints[0].translation;
      EXPECT_NEAR(length(a - b), 0, 1e-6) << written << " " << k;
    }
  }
}

TEST_F(KeptPoseTest, APoseOfAFileIsTakenByItsAmount) {
  const std::string file = (folder_ / "bent.json").string();
  run("turn upper 30 0 10; control breath 0.5");
  save_pose(session_.scene, session_.controls, file);
  run("reset-pose; turn upper 10 0 0");
  load_pose({file, 0.5}, session_.controls);
  EXPECT_DOUBLE_EQ(controls().settings.pose.joints.at("upper")[0], 20);
  EXPECT_DOUBLE_EQ(controls().settings.pose.joints.at("upper")[2], 5);
  load_pose({file}, session_.controls);
  EXPECT_DOUBLE_EQ(controls().settings.pose.joints.at("upper")[0], 30);
  ViewSettings other;
  other.pose.joints["Tentacle"] = {1, 2, 3};
  write_view_settings(other, file);
  EXPECT_EQ(kind_of([&] { load_pose({file}, session_.controls); }), ErrorKind::mismatch);
  EXPECT_FALSE(controls().settings.pose.joints.contains("Tentacle"));
}

// Alone in its file: programs before this read what they know.
TEST_F(KeptPoseTest, NewKeysAreWrittenOnlyWhereTheySaySomething) {
  const auto written = [&] {
    session_.save((folder_ / "shot.json").string());
    std::ifstream file(folder_ / "shot.json");
    return std::string(std::istreambuf_iterator<char>(file), {});
  };
  run("turn upper 30 0 0; key");
  const std::string plain = written();
  for (const char* key : {"moves", "facing", "ease"}) EXPECT_EQ(plain.find(key), std::string::npos) << key;
  run("move lower 0 0.1 0; key; ease step");
  const std::string more = written();
  for (const char* key : {"moves", "ease"}) EXPECT_NE(more.find(key), std::string::npos) << key;
}

TEST_F(KeptPoseTest, FilesOfOtherKindsAreRefused) {
  EXPECT_EQ(kind_of([&] { run("export-clip take.fbx"); }), ErrorKind::usage);
  EXPECT_EQ(kind_of([&] { run("export-skin take.abc"); }), ErrorKind::usage);
}

}  // namespace pose_keys_test
}  // namespace bodyopt::testing
