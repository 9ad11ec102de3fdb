// What is open, and what becomes of it when files and settings change.
#include "viewport/session.h"

#include <gtest/gtest.h>

#include "runtime/core/error.h"
#include "shots/session/pinned_joints.h"
#include "tests/curate/curated_limb.h"
#include "tests/support/error_kind.h"
#include "tests/support/gpu_fixture.h"
#include "tests/viewport/small_character.h"
#include "viewport/commands/commands.h"
#include "viewport/describe_scene.h"

namespace bodyopt::testing {
namespace {

using namespace trainer;
using namespace shots;
using namespace viewport;

class SessionTest : public ::testing::Test {
 protected:
  void SetUp() override {
    session_.open_first();
    session_.open(small_.clip);
    session_.play_clip();
  }

  // Goes along +x.
  std::string walking_clip() {
    Clip clip = bending_clip(small_.made.skeleton);
    for (std::size_t k = 0; k < clip.poses.size(); ++k) {
      clip.poses[k].joints[0].translation[0] += 0.5 * static_cast<double>(k);
    }
    const std::string file = (folder_ / "walk.glb").string();
    write_clip(clip, small_.made.skeleton, file);
    return file;
  }
  // With a picture.
  void go_to(int frame) {
    session_.controls.playback.scrub(frame);
    session_.framing.follow();
  }
  double target_from_character() const {
    return session_.controls.camera.view().target[0] - session_.scene.whereabouts(playback().frame())[0];
  }
  // The first frames of the clip.
  std::string shorter_clip(std::size_t count) {
    Clip clip = bending_clip(small_.made.skeleton);
    clip.name = "short";
    clip.poses.resize(count);
    const std::string file = (folder_ / "short.glb").string();
    write_clip(clip, small_.made.skeleton, file);
    return file;
  }
  std::string state(const std::string& playback) {
    const auto file = folder_ / "state.json";
    std::ofstream(file) << R"({"schema": "bodyopt-view-1", "playback": )" << playback << "}";
    return file.string();
  }
  void expect_range(int in, int out) const {
    EXPECT_EQ(playback().in(), in);
    EXPECT_EQ(playback().out(), out);
  }
  // Is that the last thing that was said?
  void expect_said(const std::string& text) const {
    ASSERT_FALSE(session_.controls.messages.empty());
    const std::string& last = session_.controls.messages.back().text;
    EXPECT_NE(last.find(text), std::string::npos) << last;
  }
  const Playback& playback() const { return session_.controls.playback; }
  std::vector<std::filesystem::path> all() const { return session_.scene.paths(); }

  TemporaryFolder folder_;
  SmallCharacter small_{folder_};
  const ViewerOptions options_ = [this] {
    ViewerOptions options;
    options.files = {small_.basis};
    return options;
  }();
  Session session_{open_test_device(), options_};
};

TEST_F(SessionTest, ARangeIsPlayedAsFarAsTheClipHasIt) {
  session_.load_state(state(R"({"in": 5, "out": 20})"));
  expect_range(5, 12);
  expect_said("5-20");
  session_.load_state(state(R"({"in": 1001, "out": 1100})"));
  expect_range(1, 12);
  expect_said("all of the clip");
  session_.load_state(state(R"({"in": 3, "out": 4})"));
  expect_range(3, 4);
  session_.load_state(state("{}"));
  expect_range(1, 12);
}

TEST_F(SessionTest, AClipOfOtherFramesIsOpenedWhole) {
  session_.controls.playback.set_range(8, 10);
  session_.play_clip();
  expect_range(8, 10);
  session_.open(shorter_clip(5));
  expect_range(1, 5);
  EXPECT_EQ(session_.snapshot.cast[0].clip, "short");
  expect_said("8-10");
}

TEST_F(SessionTest, AReloadGoesOnPlaying) {
  Playback& playing = session_.controls.playback;
  playing.scrub(7);
  playing.set_backwards(true);
  playing.play();
  playing.set_range(2, 12);
  session_.reload(all());
  EXPECT_TRUE(playback().playing());
  EXPECT_TRUE(playback().backwards());
  EXPECT_EQ(playback().frame(), 7);
  expect_range(2, 12);
  playing.pause();
  session_.reload(all());
  EXPECT_FALSE(playback().playing());
}

TEST_F(SessionTest, OnlyThoseWhoseFilesChangedAreReadAgain) {
  const JigglingCharacter other(folder_);
  session_.open(other.basis);
  const Actor* first = session_.scene.cast()[0].get();
  const Actor* second = session_.scene.cast()[1].get();
  session_.reload({other.basis});
  EXPECT_EQ(session_.scene.cast()[0].get(), first);
  EXPECT_NE(session_.scene.cast()[1].get(), second);
}

TEST_F(SessionTest, PanelsSpeakOfTheLeadAndFilesGoToIt) {
  const JigglingCharacter other(folder_);
  session_.open(other.basis);
  session_.open(other.clip);
  const Actor* first = session_.scene.cast()[0].get();
  Actor* second = session_.scene.cast()[1].get();
  session_.controls.playback.scrub(5);
  session_.make_lead(2);
  EXPECT_EQ(&session_.scene.lead(), second);
  EXPECT_EQ(session_.scene.cast()[1].get(), first);
  EXPECT_EQ(session_.snapshot.cast[0].name, second->name());
  EXPECT_EQ(session_.controls.joint_names.size(), other.made.basis.skeleton.size());
  EXPECT_EQ(playback().last(), second->clip().last_frame());
  EXPECT_EQ(playback().frame(), 5);
  EXPECT_EQ(session_.controls.cast_numbers, (std::vector<int>{2, 1}));
  session_.make_lead(2);
  EXPECT_EQ(&session_.scene.lead(), second) << "it keeps its number";
  session_.make_lead(1);
  EXPECT_EQ(&session_.scene.lead(), first);
  session_.open(shorter_clip(3));
  EXPECT_EQ(first->clip().name, "short");
  EXPECT_NE(second->clip().name, "short");
  EXPECT_EQ(playback().last(), first->clip().last_frame());
  for (const int number : {-1, 0, 3}) {
    EXPECT_EQ(kind_of([&] { session_.make_lead(number); }), ErrorKind::usage) << number;
    EXPECT_EQ(kind_of([&] { session_.remove(number); }), ErrorKind::usage) << number;
  }
}

TEST_F(SessionTest, WhoIsRemovedIsGoneButTheLastOne) {
  const JigglingCharacter other(folder_);
  session_.open(other.basis);
  const Actor* second = session_.scene.cast()[1].get();
  session_.controls.joint = small_.made.skeleton.joints[1].name;
  session_.remove(1);
  EXPECT_EQ(session_.controls.joint, "");
  ASSERT_EQ(session_.scene.cast().size(), 1u);
  EXPECT_EQ(&session_.scene.lead(), second);
  EXPECT_EQ(session_.snapshot.cast.size(), 1u);
  EXPECT_EQ(session_.snapshot.cast[0].name, second->name());
  for (const auto& file : all()) EXPECT_NE(file, small_.basis);
  EXPECT_EQ(kind_of([&] { session_.remove(1); }), ErrorKind::usage);
  EXPECT_EQ(&session_.scene.lead(), second);
}

TEST_F(SessionTest, WhoLeavesTheStageTakesNothingFromTheLead) {
  const JigglingCharacter other(folder_);
  for (int k = 0; k < 2; ++k) session_.open(other.basis);
  session_.controls.joint = small_.made.skeleton.joints[1].name;
  session_.controls.requests = {};
  Actor* last = session_.scene.cast()[2].get();
  session_.remove(2);
  EXPECT_EQ(session_.controls.cast_numbers, (std::vector<int>{1, 3}));
  EXPECT_EQ(kind_of([&] { session_.make_lead(2); }), ErrorKind::usage);
  EXPECT_EQ(session_.controls.joint, small_.made.skeleton.joints[1].name);
  EXPECT_FALSE(session_.controls.requests.frame_selection);
  session_.open(other.clip);
  EXPECT_EQ(last->files().clip, other.clip) << "to whom files went before";
  session_.make_lead(1);
  session_.open(small_.clip);
  EXPECT_EQ(last->files().clip, other.clip);
}

TEST_F(SessionTest, EveryOneHasItsOwnTurns) {
  session_.open(small_.basis);
  const std::string joint = small_.made.skeleton.joints[1].name;
  const auto turned = [&](std::size_t index) {
    const Actor& character = *session_.scene.cast()[index];
    return length(degrees_of(conjugate(character.pose(1, {}).joints[1].rotation) *
                             session_.scene.pose_at(character, 1, session_.controls).joints[1].rotation));
  };
  run_command(session_.controls, "correction 0.5");
  run_command(session_.controls, "turn " + joint + " 30 0 0");
  EXPECT_NEAR(turned(0), 30, 1e-6);
  EXPECT_NEAR(turned(1), 0, 1e-6);
  session_.make_lead(2);
  EXPECT_NEAR(turned(0), 0, 1e-6);
  EXPECT_NEAR(turned(1), 30, 1e-6);
  EXPECT_EQ(session_.controls.settings.pose.correction, 0.5);
  run_command(session_.controls, "turn " + joint + " 0 20 0");
  session_.reload(all());
  EXPECT_NEAR(turned(1), 30, 1e-6);
  session_.make_lead(1);
  EXPECT_EQ(session_.controls.settings.pose.joints.at(joint), (Vec3{30, 0, 0}));
  run_command(session_.controls, "undo");
  EXPECT_EQ(session_.controls.settings.pose.joints.at(joint), (Vec3{30, 0, 0})) << "another's step is not undone";
}

TEST_F(SessionTest, AReloadThatFailsLeavesAllAsItWas) {
  const JigglingCharacter other(folder_);
  session_.open(other.basis);
  const Actor* first = session_.scene.cast()[0].get();
  const std::size_t joints = session_.snapshot.joints.size();
  session_.controls.joint = small_.made.skeleton.joints[1].name;
  session_.controls.playback.play();
  save_basis(other.made.basis, small_.basis);  // which would be read
  std::filesystem::resize_file(other.basis, std::filesystem::file_size(other.basis) / 2);
  EXPECT_THROW(session_.reload(all()), Error);
  EXPECT_EQ(session_.scene.cast()[0].get(), first);
  EXPECT_EQ(session_.snapshot.joints.size(), joints);
  EXPECT_EQ(session_.controls.joint, small_.made.skeleton.joints[1].name);
  EXPECT_TRUE(playback().playing());
}

TEST_F(SessionTest, AJointThatIsGoneIsSelectedNoLonger) {
  session_.controls.joint = small_.made.skeleton.joints[1].name;
  session_.reload(all());
  EXPECT_EQ(session_.controls.joint, small_.made.skeleton.joints[1].name);
  Basis renamed = small_.made;
  renamed.skeleton.joints[1].name = "renamed";
  save_basis(renamed, small_.basis);
  session_.reload(all());
  EXPECT_EQ(session_.controls.joint, "");
  EXPECT_EQ(session_.controls.joint_names[1], "renamed");
}

TEST_F(SessionTest, FramingFitsOneOfTwoViews) {
  const auto distance = [&](CompareLayout layout) {
    session_.controls.settings.compare.layout = layout;
    session_.framing.frame_selection(200, 200);
    return session_.controls.camera.view().distance;
  };
  session_.controls.settings.compare.with = CompareWith::ddm;
  session_.controls.settings.pose.joints[small_.made.skeleton.joints[0].name] = {0, 0, 90};  // wider than high
  EXPECT_GT(distance(CompareLayout::side_by_side), 1.2 * distance(CompareLayout::wipe));
}

// Names over a tenth of the picture, and as much below them, leave four fifths of its height.
TEST_F(SessionTest, FramingLeavesRoomForNames) {
  session_.framing.frame_selection(200, 200);
  const double free = session_.controls.camera.view().distance;
  session_.framing.keep_framed(200, 200, {.top = 20});
  EXPECT_NEAR(session_.controls.camera.view().distance, free / 0.8, 1e-3 * free);
  session_.framing.keep_framed(200, 200, {});
  EXPECT_NEAR(session_.controls.camera.view().distance, free, 1e-6 * free);
}

// As long as nobody has moved the camera since.
TEST_F(SessionTest, WhatWasFramedFitsWhenAComparisonTakesHalfThePicture) {
  const auto view = [&] { return session_.controls.camera.view(); };
  session_.controls.settings.pose.joints[small_.made.skeleton.joints[0].name] = {0, 0, 90};  // wider than high
  session_.framing.frame_selection(200, 200);
  const OrbitView whole = view();
  session_.framing.keep_framed(200, 200);
  EXPECT_EQ(view(), whole);
  session_.controls.settings.compare.with = CompareWith::ddm;
  session_.framing.keep_framed(200, 200);
  EXPECT_GT(view().distance, 1.2 * whole.distance);
  session_.controls.settings.compare.with = CompareWith::none;
  session_.framing.keep_framed(200, 200);
  EXPECT_NEAR(view().distance, whole.distance, 1e-9);
  session_.controls.camera.dolly(1);
  const OrbitView moved = view();
  session_.controls.settings.compare.with = CompareWith::ddm;
  session_.framing.keep_framed(200, 200);
  EXPECT_EQ(view(), moved);
}

// As the commands "compare ddm; right" ask for before one picture.
TEST_F(SessionTest, WhatWasFramedFitsAComparisonThatIsSeenFromAnotherSide) {
  const auto view = [&] { return session_.controls.camera.view(); };
  session_.controls.settings.pose.joints[small_.made.skeleton.joints[0].name] = {0, 0, 90};  // wider than high
  session_.framing.frame_selection(200, 200);
  session_.controls.settings.compare.with = CompareWith::ddm;
  session_.controls.camera.view_axis(AxisView::back);
  session_.framing.keep_framed(200, 200);
  const OrbitView kept = view();
  session_.framing.frame_selection(200, 200);
  EXPECT_NEAR(kept.distance, view().distance, 1e-6 * kept.distance);
  EXPECT_EQ(kept.azimuth, view().azimuth);
}

TEST_F(SessionTest, FramingSeesWhatIsComparedAndWhatIsAddedLater) {
  const std::string high = (folder_ / "high.pc2").string();
  write_truth(small_.made, read_clip(small_.clip, small_.made.skeleton, {}), 2, high);
  session_.framing.frame_selection(200, 200);
  const OrbitView alone = session_.controls.camera.view();
  session_.open(high);
  session_.framing.frame_selection(200, 200);
  EXPECT_GT(session_.controls.camera.view().target[1], alone.target[1] + 0.5) << "2 m above";
  session_.controls.requests = {};
  session_.open(small_.basis);
  EXPECT_TRUE(session_.controls.requests.frame_selection);
}

TEST_F(SessionTest, CamerasThatWereKeptGoAlongWithTheCharacter) {
  Controls& controls = session_.controls;
  session_.open(walking_clip());
  go_to(1);
  go_to(4);
  controls.camera.move({0.25 - target_from_character(), 1, 0});
  run_command(controls, "save-camera side");
  const std::string file = (folder_ / "s.json").string();
  session_.save_state(file);
  go_to(11);
  EXPECT_NEAR(target_from_character(), 0.25, 1e-9);
  for (const bool by_state : {true, false}) {
    controls.camera.move({9, 0, 0});
    if (by_state) {
      session_.load_state(file);
    } else {
      run_command(controls, "camera side");
    }
    session_.framing.follow();
    EXPECT_NEAR(target_from_character(), 0.25, 1e-9) << by_state;
    EXPECT_NEAR(controls.camera.view().target[1], 1, 1e-9);
  }
  go_to(3);
  EXPECT_NEAR(target_from_character(), 0.25, 1e-9);
  // One that does not follow is where the file says.
  std::ofstream(file) << R"({"schema": "bodyopt-view-1", "look": {"follow": false}, "camera": {"target": [7, 0, 0]}})";
  session_.load_state(file);
  go_to(11);
  EXPECT_EQ(controls.camera.view().target[0], 7);
  session_.save_state(file);
  EXPECT_EQ(read_view_settings(file).camera.target[0], 7);
}

TEST_F(SessionTest, WhatLearnedNothingIsNamedByWhatItIs) {
  const auto shown = [](Session& session) {
    describe_comparison(session.scene, session.controls, ErrorCurve(), session.snapshot);
    return session.snapshot.cast[0].method;
  };
  EXPECT_EQ(shown(session_), "learned");
  const ViewerOptions none;
  Session arm(open_test_device(), none);
  arm.open_first();
  EXPECT_EQ(shown(arm), "Direct Delta Mush");
  arm.controls.settings.compare.with = CompareWith::linear;
  shown(arm);
  EXPECT_EQ(arm.snapshot.compared, "Direct Delta Mush");
}

TEST_F(SessionTest, CommandsThatHaveNothingToShowSayWhatIsMissing) {
  const auto refusal = [&](const std::string& command) -> std::string {
    try {
      run_command(session_.controls, command);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::usage);
      return error.what();
    }
    return "";
  };
  const ViewSettings before = session_.controls.settings;
  for (const auto& [command, help] : {std::pair("compare lbs", "--character"),
                                      {"compare proxy", "--proxy"},
                                      {"compare truth", "--truth"},
                                      {"compare jiggle", "bodyopt dynamics"},
                                      {"jiggle on", "bodyopt dynamics"},
                                      {"jiggle", "bodyopt dynamics"},
                                      {"tets", "bodyopt dynamics"}}) {
    EXPECT_NE(refusal(command).find(help), std::string::npos) << command << ": " << refusal(command);
  }
  EXPECT_EQ(session_.controls.settings, before);
  for (const char* command : {"jiggle off", "compare ddm", "fibres on"}) EXPECT_EQ(refusal(command), "") << command;
  session_.open(small_.truth);
  EXPECT_EQ(refusal("compare truth"), "");
}

// The dynamics step 24 frames a second.
TEST(SessionRates, JiggleOfAnotherRateIsLeftOutAndSaid) {
  const TemporaryFolder folder;
  const JigglingCharacter limb(folder);
  ViewerOptions options;
  options.files = {limb.basis};
  options.clip.fps = 30;
  Session session(open_test_device(), options);
  session.open_first();
  EXPECT_TRUE(session.scene.lead().has(SkinMethod::jiggle)) << "a pose alone has no rate";
  run_command(session.controls, "jiggle on");
  session.open(limb.clip);
  EXPECT_EQ(shown_method(session.scene.lead(), session.controls.settings), SkinMethod::full);
  ASSERT_FALSE(session.controls.messages.empty());
  EXPECT_NE(session.controls.messages.back().text.find("--fps 24"), std::string::npos);
  run_command(session.controls, "jiggle off");
  EXPECT_EQ(kind_of([&] { run_command(session.controls, "jiggle on"); }), ErrorKind::usage);
  EXPECT_NO_THROW(run_command(session.controls, "tets on"));
}

// A dataset's shapes are of its own frames: it says so where those take the place of a clip.
TEST(SessionDatasets, SayWhichClipTheirFramesReplace) {
  const CuratedLimb limb;
  ViewerOptions options;
  options.files = {(limb.folder() / "limb.glb").string()};
  Session session(open_test_device(), options);
  session.open_first();
  session.open((limb.folder() / "one.glb").string());
  const std::vector<std::string> notes = session.open(limb.folder().string());
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_TRUE(notes[0].starts_with("one.glb: in its place play the frames of ")) << notes[0];
  EXPECT_TRUE(session.open(limb.folder().string()).empty());
}

// Frames of a dataset's takes follow each other, and those of motion capture lie far from the others: the camera goes
// to where the character is in the frame that is chosen, whatever take is beside it.
TEST(SessionDatasets, TheCameraGoesToTheFrameThatIsChosen) {
  const CuratedLimb limb;
  Dataset dataset = read_dataset(limb.path());
  Clip away = read_clip((limb.folder() / "two.glb").string(), limb.character().skeleton, {});
  for (Pose& pose : away.poses) pose.joints[0].translation[0] += 10;
  write_clip(away, limb.character().skeleton, limb.folder() / "two.glb");
  ViewerOptions options;
  options.files = {limb.folder().string()};
  Session session(open_test_device(), options);
  session.open_first();
  session.play_clip();
  const int last = kSweepFrames;  // of the first take
  EXPECT_NEAR(session.scene.whereabouts(last)[0], 0, 1e-6);
  EXPECT_NEAR(session.scene.whereabouts(last + 1)[0], 10, 1e-6);
  session.framing.follow();
  const double before = session.controls.camera.view().target[0];
  session.controls.playback.scrub(last + 1);
  session.framing.follow();
  EXPECT_NEAR(session.controls.camera.view().target[0] - before, 10, 1e-6);
}

// By whatever they are turned: a command here.
TEST(SessionLimits, HoldTheJointsThatAreTurned) {
  const TemporaryFolder folder;
  const SmallCharacter small(folder);
  const Joint& upper = small.made.skeleton.joints[1];
  const Vec3 own_x = rotate(conjugate(decompose(upper.inverse_bind).rotation), {1, 0, 0});
  ViewerOptions options;
  options.files = {small.basis};
  options.limits = (folder / "own_limits.json").string();
  write_joint_limits({{{"bend", 0, -20, 50, {{1, own_x, 1}}}}}, small.made.skeleton, options.limits);
  Session session(open_test_device(), options);
  session.open_first();
  const auto angles = [&](const std::string& command) {
    run_command(session.controls, command);
    const Pose pose = session.scene.lead().pose(1, session.controls.settings.pose);
    return degrees_of(conjugate(upper.bind.rotation) * pose.joints[1].rotation);
  };
  EXPECT_LT(length(angles("turn upper 30 0 0") - Vec3{30, 0, 0}), 1e-6);
  EXPECT_LT(length(angles("turn upper 80 40 0") - Vec3{50, 0, 0}), 1e-6);
  EXPECT_LT(length(angles("turn upper -80 0 0") - Vec3{-20, 0, 0}), 1e-6);
  describe_turns(session.scene, session.controls, session.snapshot);
  EXPECT_NEAR(session.snapshot.joints[1].low[0], -20, 1e-6);
  EXPECT_NEAR(session.snapshot.joints[1].high[0], 50, 1e-6);
  EXPECT_NEAR(session.snapshot.joints[1].high[1], 0, 1e-6);
  EXPECT_EQ(session.snapshot.joints[0].high, JointRow{}.high) << "a root";
  // They are the first character's, whoever is the lead, and are read again.
  session.open(small.basis);
  session.make_lead(2);
  EXPECT_LT(length(angles("turn upper 80 0 0") - Vec3{80, 0, 0}), 1e-6);
  session.make_lead(1);
  write_joint_limits({{{"bend", 0, -20, 60, {{1, own_x, 1}}}}}, small.made.skeleton, options.limits);
  session.reload({options.limits});
  EXPECT_LT(length(angles("turn upper 80 0 0") - Vec3{60, 0, 0}), 1e-6);
}

// As dynamics are; not those of another body, and not where others are named.
TEST(SessionLimits, BesideACharacterAreTakenAlong) {
  const TemporaryFolder folder;
  const SmallCharacter small(folder);
  const std::string beside = (folder / "limits.json").string(), other = (folder / "other.json").string();
  const Skeleton& skeleton = small.made.skeleton;
  write_joint_limits({{{"bend", 0, -20, 50, {{1, {1, 0, 0}, 1}}}}}, skeleton, beside);
  write_joint_limits({{{"twist", 0, -20, 50, {{1, {0, 1, 0}, 1}}}}}, skeleton, other);
  ViewerOptions options;
  options.files = {small.basis};
  Session session(open_test_device(), options);
  session.open_first();
  ASSERT_EQ(session.controls.axis_names, std::vector<std::string>{"bend"});
  run_command(session.controls, "turn upper 5 0 0");
  session.use_limits(other);
  EXPECT_EQ(session.controls.axis_names, std::vector<std::string>{"twist"});
  EXPECT_EQ(session.controls.settings.pose.joints.at("upper")[0], 5);
  session.use_limits("none");
  EXPECT_TRUE(session.controls.axis_names.empty());
  EXPECT_THROW(session.use_limits(small.clip), Error);
  options.limits = other;
  Session named(open_test_device(), options);
  named.open_first();
  EXPECT_EQ(named.controls.axis_names, std::vector<std::string>{"twist"});
  Skeleton strange = skeleton;
  for (Joint& joint : strange.joints) joint.name = "strange " + joint.name;
  write_joint_limits({{{"bend", 0, -20, 50, {{1, {1, 0, 0}, 1}}}}}, strange, beside);
  options.limits.clear();
  Session without(open_test_device(), options);
  const std::vector<std::string> notes = without.open_first();
  EXPECT_TRUE(without.controls.axis_names.empty());
  ASSERT_FALSE(notes.empty());
  EXPECT_NE(notes.front().find("beside the character"), std::string::npos);
}

TEST(Attempt, SaysWhatFailsUnlessItIsTheDevice) {
  Controls controls;
  controls.attempt([] { throw Error(ErrorKind::usage, "no such thing"); });
  controls.attempt([] { std::vector<int>().at(3); });
  controls.attempt([] { throw std::filesystem::filesystem_error("a folder", std::error_code()); });
  controls.attempt([] { throw std::bad_alloc(); });
  ASSERT_EQ(controls.messages.size(), 4u);
  EXPECT_EQ(controls.messages[0].text, "no such thing");
  for (const Message& message : controls.messages) EXPECT_TRUE(message.error);
  EXPECT_THROW(controls.attempt([] { throw Error(ErrorKind::device, "lost"); }), Error);
}

}  // namespace
}  // namespace bodyopt::testing
