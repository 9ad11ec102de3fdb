// The timeline, the dope sheet and the curves under it, by the mouse.
#include "tests/viewport/drawn_panels.h"

namespace bodyopt::testing {
namespace {

using namespace draw;
using namespace viewport;

class TimelinePanelsTest : public PanelsTest {};

TEST_F(TimelinePanelsTest, TimelineAndDopeSheetTakeAQuarter) {
  const Snapshot snapshot = small_character();
  Controls controls;
  controls.dope_sheet = true;
  const Rectangle area = draw(snapshot, controls);
  EXPECT_EQ(720 - area.y - static_cast<int>(area.height), 180);
}

TEST_F(TimelinePanelsTest, ClicksPlayScrubAndFindTheWorstFrame) {
  const Snapshot snapshot = small_character();
  Controls controls;
  controls.playback = Playback({1, 3}, 24);
  for (int k = 0; k < 3; ++k) draw(snapshot, controls);
  const ImRect timeline = rectangle_of("Timeline");
  click(snapshot, controls, {timeline.Min.x + 10 + 2 * 33 + 15, timeline.Min.y + 18});  // the third of the buttons
  EXPECT_TRUE(controls.playback.playing());
  click(snapshot, controls, {timeline.Min.x + 10 + 2 * 33 + 15, timeline.Min.y + 18});
  EXPECT_FALSE(controls.playback.playing());

  const float bar = timeline.Min.y + 26;
  click(snapshot, controls, {timeline.Max.x - 12, bar});
  EXPECT_EQ(controls.playback.frame(), 3);
  ImGuiIO& io = ImGui::GetIO();
  io.MouseDown[0] = true;
  for (const float x : {timeline.Max.x - 12, 0.5f * timeline.Max.x, 300.0f}) {
    io.MousePos = {x, bar};
    draw(snapshot, controls);
  }
  io.MouseDown[0] = false;
  draw(snapshot, controls);
  EXPECT_EQ(controls.playback.frame(), 1);

  const float sparkline = timeline.Max.y - 16;
  click(snapshot, controls, {timeline.Max.x - 12, sparkline});
  EXPECT_TRUE(controls.requests.worst_frame);
  EXPECT_FALSE(controls.requests.worst_vertex);
  controls.playback.scrub(2);  // the worst of them
  click(snapshot, controls, {timeline.Max.x - 12, sparkline});
  EXPECT_TRUE(controls.requests.worst_vertex);
}

// Of 21 frames the range alone, and each key of the sheet under its frame.
TEST_F(TimelinePanelsTest, KeysAreDraggedInTheDopeSheetUnderTheRange) {
  const Snapshot snapshot = small_character();
  for (const bool of_camera : {false, true}) {
    Controls controls;
    controls.playback = Playback({1, 21}, 24);
    for (const char* line : {"in 5", "out 15", "zoom-range on", "dope-sheet on"}) run_command(controls, line);
    auto& poses = controls.settings.pose.keys;
    auto& cameras = controls.settings.shot_camera.keys;
    if (of_camera) {
      cameras[15].azimuth = 1;
    } else {
      poses[15].joints["upper"] = {10, 0, 0};
    }
    const auto has_key = [&](int at) { return of_camera ? cameras.contains(at) : poses.contains(at); };
    for (int k = 0; k < 3; ++k) draw(snapshot, controls);
    const ImRect timeline = rectangle_of("Timeline");
    const float right = timeline.Max.x - 10, between = right - 100, bar = timeline.Min.y + 26;
    click(snapshot, controls, {right - 2, bar});
    EXPECT_EQ(controls.playback.frame(), 15);
    click(snapshot, controls, {between, bar});
    const int frame = controls.playback.frame();
    ASSERT_TRUE(5 < frame && frame < 15) << frame;
    ImGuiIO& io = ImGui::GetIO();
    const float line = timeline.Min.y + 84 - 4 + 9;
    for (const auto& [x, down] : {std::pair{right - 2, false}, std::pair{right - 2, true}, std::pair{between, true},
                                  std::pair{between, false}}) {
      io.MousePos = {x, line};
      io.MouseDown[0] = down;
      draw(snapshot, controls);
    }
    EXPECT_FALSE(has_key(15)) << of_camera;
    EXPECT_TRUE(has_key(frame)) << of_camera;
  }
}

// From 0 degrees at frame 1 to 40 at the last: its key is dragged down to half, and sideways; each is one step.
TEST_F(TimelinePanelsTest, KeysOfCurvesAreDraggedToValuesAndFrames) {
  const Snapshot snapshot = small_character();
  for (const bool goes_sideways : {false, true}) {
    Controls controls;
    controls.playback = Playback({1, 21}, 24);
    run_command(controls, "curves on");
    EXPECT_TRUE(controls.dope_sheet);
    auto& keys = controls.settings.pose.keys;
    keys[1].joints["LeftArm"] = {0, 5, 0};
    keys[21].joints["LeftArm"] = {40, 5, 0};
    controls.select("LeftArm");
    controls.playback.scrub(21);
    controls.follow_keys();
    controls.poses.begin(controls.settings);
    for (int k = 0; k < 3; ++k) draw(snapshot, controls);
    const ImRect timeline = rectangle_of("Timeline");
    const float top = timeline.Min.y + 84 - 4, right = timeline.Max.x - 12;
    const ImVec2 key{right, top + 8}, to{goes_sideways ? right - 100 : right, goes_sideways ? top + 12 : top + 98};
    ImGuiIO& io = ImGui::GetIO();
    for (const auto& [at, down] :
         {std::pair{key, false}, std::pair{key, true}, std::pair{to, true}, std::pair{to, false}}) {
      io.MousePos = at;
      io.MouseDown[0] = down;
      draw(snapshot, controls);
    }
    ASSERT_EQ(keys.size(), 2u);
    EXPECT_EQ(keys.at(1).joints.at("LeftArm"), (Vec3{0, 5, 0}));
    EXPECT_EQ(keys.contains(21), !goes_sideways);
    const Vec3 turned = keys.rbegin()->second.joints.at("LeftArm");
    EXPECT_EQ(turned[1], 5);
    if (goes_sideways) {
      EXPECT_EQ(turned[0], 40);
    } else {
      EXPECT_TRUE(10 < turned[0] && turned[0] < 30) << turned[0];
      EXPECT_EQ(controls.settings.pose.joints.at("LeftArm"), turned) << "the pose in hand is the key's";
    }
    run_command(controls, "undo");
    EXPECT_EQ(keys.at(21).joints.at("LeftArm")[0], 40);
    EXPECT_FALSE(controls.poses.undo(controls.settings)) << "it was one step";
  }
}

TEST_F(TimelinePanelsTest, TheTimelineShowsWhichFramesAreMeasured) {
  Snapshot snapshot = small_character();
  snapshot.errors.assign(3, {});
  snapshot.worst.reset();
  Controls controls;
  controls.playback = Playback({1, 3}, 24);
  run_command(controls, "side-panel off");
  const auto count = [&] {
    for (int k = 0; k < 3; ++k) draw(snapshot, controls);
    return vertices();
  };
  int before = count();
  for (ErrorRow& error : snapshot.errors) {
    error.measured = true;
    const int after = count();
    EXPECT_EQ(after, before + 4) << "a rectangle more";
    before = after;
  }
}

TEST_F(TimelinePanelsTest, TheFrameNumberIsTypedInto) {
  const Snapshot snapshot = small_character();
  Controls controls;
  controls.playback = Playback({1, 40}, 24);
  for (int k = 0; k < 3; ++k) draw(snapshot, controls);
  const ImRect timeline = rectangle_of("Timeline");
  click(snapshot, controls, {timeline.Min.x + 10 + 7 * 33 + 40, timeline.Min.y + 24});
  ImGuiIO& io = ImGui::GetIO();
  EXPECT_TRUE(io.WantTextInput);
  for (const char* digit : {"3", "7"}) {
    io.AddInputCharactersUTF8(digit);
    draw(snapshot, controls);
  }
  EXPECT_EQ(controls.playback.frame(), 1);
  press(snapshot, controls, ImGuiKey_Enter);
  EXPECT_EQ(controls.playback.frame(), 37);
}

TEST_F(TimelinePanelsTest, TheTimelineTurnsRoundAndKeepsEveryFrame) {
  const Snapshot snapshot = small_character();
  Controls controls;
  for (int k = 0; k < 3; ++k) draw(snapshot, controls);
  const ImRect timeline = rectangle_of("Timeline");
  const auto button = [&](int k) {
    return ImVec2{timeline.Min.x + 10 + static_cast<float>(k) * 33 + 15, timeline.Min.y + 18};
  };
  click(snapshot, controls, button(5));
  EXPECT_TRUE(controls.playback.backwards());
  click(snapshot, controls, button(6));
  EXPECT_FALSE(controls.playback.real_time());
}

TEST_F(TimelinePanelsTest, TheEndsOfTheRangeAreDragged) {
  Snapshot snapshot = small_character();
  Controls controls;
  controls.playback = Playback({1, 100}, 24);
  for (int k = 0; k < 3; ++k) draw(snapshot, controls);
  const ImRect timeline = rectangle_of("Timeline");
  ImGuiIO& io = ImGui::GetIO();
  const ImVec2 flag{timeline.Max.x - 14, timeline.Min.y + 9};  // over the last frame
  for (const auto& [x, down] : {std::pair{flag.x, false}, std::pair{flag.x, true}, std::pair{900.0f, true},
                                std::pair{800.0f, true}, std::pair{800.0f, false}}) {
    io.MousePos = {x, flag.y};
    io.MouseDown[0] = down;
    draw(snapshot, controls);
  }
  EXPECT_EQ(controls.playback.in(), 1);
  EXPECT_GT(controls.playback.out(), 20);
  EXPECT_LT(controls.playback.out(), 80);
  EXPECT_EQ(controls.playback.frame(), 1);
}

}  // namespace
}  // namespace bodyopt::testing
