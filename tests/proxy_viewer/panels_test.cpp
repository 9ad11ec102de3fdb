#include "proxy_viewer/panels/panels.h"

#include <gtest/gtest.h>
#include <imgui.h>
#include <imgui_internal.h>

#include <cmath>
#include <map>
#include <set>

#include "proxy_viewer/commands/commands.h"
#include "proxy_viewer/platform/gui.h"
#include "shots/session/view_settings.h"
#include "tests/support/error_kind.h"

namespace bodyopt::testing {
namespace {

Snapshot small_character() {
  Snapshot s;
  s.cast = {{"arm", "arm.safetensors", "bend", "truth.pc2", 100, 180, 400, 123456, "full"}};
  s.joints = {{"Hips", -1, 0}, {"LeftArm", 0, 1}, {"RightArm", 0, 1}};
  s.controls = {{"flex", 0, 1}};
  s.fibres = {"biceps/1", "biceps/2"};
  s.strains = {-0.2f, 0.1f};
  s.comparisons = {"none", "ddm", "truth"};
  s.compared = "truth";
  s.errors = {{1, 2, true}, {3, 4, true}, {}};
  s.measured = 2;
  s.worst = 1;
  s.device = "a device";
  return s;
}

// 500 joints and 1,000 fibres with long names of other scripts, numbers that are none.
Snapshot huge_character() {
  Snapshot s;
  const std::string greek =
      "\xce\xb1\xcf\x81\xce\xb9\xcf\x83\xcf\x84\xce\xb5\xcf\x81\xcf\x8c\xcf\x82 \xcf\x8e\xce\xbc\xce\xbf\xcf\x82";
  const std::string japanese =
      "\xe5\xb7\xa6\xe8\x85\x95%s##\xe3\x83\xbb\xe4\xb8\x8a\xe8\x85\x95\xe4\xba\x8c\xe9\xa0\xad\xe7\xad\x8b";
  for (int c = 0; c < 20; ++c) {
    s.cast.push_back({japanese, greek, greek, greek, 4000000000u, 4000000000u, 98456, 1ull << 40, "jiggle"});
  }
  for (int j = 0; j < 500; ++j) s.joints.push_back({j % 3 == 0 ? greek : japanese, j - 1, j});
  for (int c = 0; c < 60; ++c) s.controls.push_back({greek, 0, 1});
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  for (int f = 0; f < 1000; ++f) {
    s.fibres.push_back(japanese);
    s.strains.push_back(f == 7 ? inf : static_cast<float>(f % 200) / 100 - 1);
  }
  s.errors.assign(20000, {1e9f, inf, true});
  s.errors[3] = {nan, nan, true};
  s.errors[4] = {};
  s.measured = 19999;
  s.worst = 0;
  s.outside = 12;
  s.outside_feature = greek;
  s.expected_mm = 1e6;
  s.level_count = 9;
  s.compared = greek;
  s.device = japanese;
  return s;
}

// As a dataset of three frames is looked at.
CurationRow small_dataset() {
  CurationRow row;
  row.region = "forearm";
  row.dots = {{-1, 0, 0, "rom 1"}, {0, 1, 0.5f, "rom 2"}, {1, -1, NAN, "rom 3"}};
  row.legend = "hottest: 3.00 mm";
  row.modifiers = {{"elbow", "sculpt", true, 0.5}, {"smooth", "smooth", false, 1}};
  row.pairs = {"3.00 mm  rom 1 - rom 3  forearm"};
  return row;
}

// As two bodies match.
MatchRow small_match() {
  MatchRow row{false, 0.9, 1.1, {{"LeftArm", 0.6, 2.3, 0.4, true}, {"Hips", 0.95, 1, 0.1, false}}};
  row.volumes = {1.013, 0.994};
  row.to_simulate = "3, 12-14";
  return row;
}

// Without muscles, clip, controls or errors.
Snapshot bare_character() {
  Snapshot s;
  s.joints = {{"root"}};
  return s;
}

Controls controls_with_all_open(const Snapshot& snapshot) {
  Controls controls;
  const int count = static_cast<int>(std::max<std::size_t>(3, snapshot.errors.size()));
  controls.playback = Playback({1, count}, 24);
  controls.playback.set_keys({2});
  for (const JointRow& row : snapshot.joints) controls.joint_names.push_back(row.name);
  controls.joint = snapshot.joints.back().name;
  for (const Section& section : kSections) controls.settings.hud.panels[section.name] = true;
  controls.settings.look.tets = controls.settings.compare.heat = true;
  controls.settings.compare.with = CompareWith::truth;
  controls.settings.cameras["close"] = {};
  controls.prompt = controls.cheat_sheet = true;
  controls.dialog = FileDialog{"open", "/", "a.glb", {{"..", true}, {"a.glb", false}}};
  controls.messages.push_back(
      {.error = true, .text = "a long text that names a file, what was expected and what was found instead of it"});
  return controls;
}

class PanelsTest : public ::testing::Test {
 protected:
  // One picture of the panels, as the application makes them.
  Rectangle draw(const Snapshot& snapshot, Controls& controls, std::uint32_t width = 1280, std::uint32_t height = 720) {
    visit_texts(snapshot, controls, [this](const std::string& text) { gui_.fonts().show(text); });
    gui_.begin(width, height, 1.0 / 60);
    const Rectangle area = draw_panels(snapshot, controls, width, height);
    gui_.end();
    return area;
  }

  static int vertices() { return ImGui::GetDrawData()->TotalVtxCount; }

  static ImRect rectangle_of(const char* window) { return ImGui::FindWindowByName(window)->Rect(); }

  // The mouse goes there, presses, and lets go, each in a picture of its own.
  void click(const Snapshot& snapshot, Controls& controls, ImVec2 at) {
    ImGuiIO& io = ImGui::GetIO();
    io.MousePos = at;
    for (const bool down : {false, true, false}) {
      io.MouseDown[0] = down;
      draw(snapshot, controls);
    }
  }

  // A key goes down and up again, each in a picture of its own.
  void press(const Snapshot& snapshot, Controls& controls, ImGuiKey key) {
    ImGuiIO& io = ImGui::GetIO();
    io.KeyMap[key] = key;  // any number will do
    for (const bool down : {true, false}) {
      io.KeysDown[key] = down;
      draw(snapshot, controls);
    }
  }

  Gui gui_;
};

TEST_F(PanelsTest, EverySizeOfWindowAndCharacterIsDrawn) {
  Snapshot with_dataset = small_character();
  with_dataset.curation = small_dataset();
  for (const Snapshot& snapshot : {small_character(), huge_character(), bare_character(), with_dataset}) {
    for (const auto& [width, height] : {std::pair{200u, 150u}, std::pair{1u, 1u}, std::pair{640u, 360u},
                                        std::pair{1280u, 720u}, std::pair{4096u, 2160u}}) {
      for (int layout = 0; layout < 4; ++layout) {
        Controls controls = controls_with_all_open(snapshot);
        controls.settings.compare.layout = static_cast<CompareLayout>(layout);
        for (int k = 0; k < 3; ++k) {
          const Rectangle area = draw(snapshot, controls, width, height);
          EXPECT_GE(area.width, 1u);
          EXPECT_LE(area.x + area.width, width);
          EXPECT_GE(area.height, 1u);
        }
        EXPECT_GT(vertices(), 0);
        const ImDrawData& data = *ImGui::GetDrawData();
        for (int l = 0; l < data.CmdListsCount; ++l) {
          for (const ImDrawVert& v : data.CmdLists[l]->VtxBuffer) {
            ASSERT_TRUE(std::isfinite(v.pos.x) && std::isfinite(v.pos.y)) << width << " x " << height;
          }
        }
      }
    }
  }
}

// Letters come as fast as they like, from the picture that shows the prompt on; Enter runs what they say.
TEST_F(PanelsTest, ThePromptHearsFromItsFirstPicture) {
  const Snapshot snapshot = small_character();
  Controls controls;
  controls.playback = Playback({1, 100}, 24);
  for (int k = 0; k < 3; ++k) draw(snapshot, controls);
  ImGuiIO& io = ImGui::GetIO();
  controls.prompt = true;
  controls.typed.prompt = "frame ";  // as menus begin it
  for (const char letter : std::string("123")) {
    io.AddInputCharacter(static_cast<unsigned>(letter));
    draw(snapshot, controls);
  }
  press(snapshot, controls, ImGuiKey_Backspace);
  press(snapshot, controls, ImGuiKey_Enter);
  EXPECT_TRUE(controls.messages.empty()) << controls.messages.front().text;
  EXPECT_EQ(controls.playback.frame(), 12);
  EXPECT_FALSE(controls.prompt);
}

TEST_F(PanelsTest, EverySectionDrawsSomething) {
  Snapshot snapshot = small_character();
  snapshot.curation = small_dataset();
  snapshot.cast.push_back(snapshot.cast.front());
  snapshot.match = small_match();
  Controls controls = controls_with_all_open(snapshot);
  controls.prompt = controls.cheat_sheet = false;
  for (const Section& section : kSections) controls.settings.hud.panels[section.name] = false;
  for (int k = 0; k < 3; ++k) draw(snapshot, controls);
  const int closed = vertices();
  for (const Section& section : kSections) {
    run_command(controls, std::string("section ") + section.name);
    for (int k = 0; k < 3; ++k) draw(snapshot, controls);
    EXPECT_GT(vertices(), closed + 40) << section.name;
  }
}

TEST_F(PanelsTest, CoverageHasAColourBarOrAWordWhyNot) {
  Snapshot snapshot = small_character();
  snapshot.compared.clear();
  Controls controls;
  const auto drawn = [&] {
    for (int k = 0; k < 3; ++k) draw(snapshot, controls);
    return vertices();
  };
  run_command(controls, "section look");  // whatever the section of comparing shows
  const int without = drawn();
  controls.settings.compare.coverage = true;
  const int unknown = drawn();
  snapshot.knows_coverage = true;
  const int bar = drawn();
  snapshot.most_expected_mm = 3;
  EXPECT_GT(unknown, without + 40);
  EXPECT_GT(bar, unknown);
  EXPECT_GT(drawn(), bar + 40);
}

TEST_F(PanelsTest, HeatOfNothingSaysWhy) {
  Snapshot snapshot = small_character();
  Controls controls;
  run_command(controls, "side-panel off");
  const auto drawn = [&](bool heat, const std::string& compared) {
    controls.settings.compare.heat = heat;
    snapshot.compared = compared;
    for (int k = 0; k < 3; ++k) draw(snapshot, controls);
    return vertices();
  };
  EXPECT_GT(drawn(true, ""), drawn(false, "") + 40);
}

// Figures over the first of two side by side: what matters alone.
TEST_F(PanelsTest, FiguresLeaveTheFirstOfTwoAlone) {
  const Snapshot snapshot = small_character();
  Controls controls;
  run_command(controls, "side-panel off");
  const auto figures = [&](CompareLayout layout) {
    controls.settings.compare.layout = layout;
    int vertices_of[2];
    for (const bool on : {false, true}) {
      controls.settings.hud.on = on;
      for (int k = 0; k < 3; ++k) draw(snapshot, controls);
      vertices_of[on] = vertices();
    }
    return vertices_of[1] - vertices_of[0];
  };
  EXPECT_LT(3 * figures(CompareLayout::side_by_side), figures(CompareLayout::overlay));
  EXPECT_GT(figures(CompareLayout::side_by_side), 40);
}

TEST_F(PanelsTest, TimelineAndDopeSheetTakeAQuarter) {
  const Snapshot snapshot = small_character();
  Controls controls;
  controls.dope_sheet = true;
  const Rectangle area = draw(snapshot, controls);
  EXPECT_EQ(720 - area.y - static_cast<int>(area.height), 180);
}

TEST_F(PanelsTest, AMatchSaysWhatItsColoursAre) {
  Snapshot snapshot = small_character();
  snapshot.compared.clear();
  Controls controls;
  run_command(controls, "side-panel off");
  const auto drawn = [&](const char* command) {
    run_command(controls, command);
    for (int k = 0; k < 3; ++k) draw(snapshot, controls);
    return vertices();
  };
  const int without = drawn("match colours");  // nothing is matched yet
  EXPECT_EQ(drawn("match confidence"), without);
  snapshot.match = small_match();
  EXPECT_GT(drawn("match colours"), without + 40);
  EXPECT_GT(drawn("match confidence"), without + 4 * 44);  // a bar of 44 steps
}

TEST_F(PanelsTest, HiddenPanelsLeaveAllToThePicture) {
  const Snapshot snapshot = small_character();
  Controls controls;
  const Rectangle with = draw(snapshot, controls);
  EXPECT_LT(with.width, 1280u);
  EXPECT_GT(with.y, 0);
  run_command(controls, "side-panel off");
  EXPECT_EQ(draw(snapshot, controls).width, 1280u);
  run_command(controls, "panels off");
  const Rectangle without = draw(snapshot, controls);
  EXPECT_EQ(without.y, 0);
  EXPECT_EQ(without.width, 1280u);
  EXPECT_EQ(without.height, 720u);
}

TEST_F(PanelsTest, ClicksPlayScrubAndFindTheWorstFrame) {
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
TEST_F(PanelsTest, KeysAreDraggedInTheDopeSheetUnderTheRange) {
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
TEST_F(PanelsTest, KeysOfCurvesAreDraggedToValuesAndFrames) {
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

TEST_F(PanelsTest, TheTimelineShowsWhichFramesAreMeasured) {
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

TEST_F(PanelsTest, TheLineOfAWipeIsDragged) {
  const Snapshot snapshot = small_character();
  Controls controls;
  controls.settings.compare.layout = CompareLayout::wipe;
  const Rectangle area = draw(snapshot, controls);
  ImGuiIO& io = ImGui::GetIO();
  for (const auto& [share, down] : {std::pair{0.5f, false}, std::pair{0.5f, true}, std::pair{0.5f, true},
                                    std::pair{0.25f, true}, std::pair{0.25f, false}}) {
    io.MousePos = {share * static_cast<float>(area.width), 400};
    io.MouseDown[0] = down;
    draw(snapshot, controls);
  }
  EXPECT_NEAR(controls.settings.compare.wipe, 0.25, 0.01);
}

TEST_F(PanelsTest, TheLegendIsThereWithoutTheHud) {
  const Snapshot snapshot = small_character();
  Controls controls;
  run_command(controls, "panels off");
  run_command(controls, "hud off");
  run_command(controls, "layout wipe");
  run_command(controls, "heat on");
  run_command(controls, "legend off");
  for (int k = 0; k < 2; ++k) draw(snapshot, controls);
  EXPECT_EQ(vertices(), 0);
  run_command(controls, "heat off");
  run_command(controls, "legend on");
  draw(snapshot, controls);
  const int sides = vertices();
  EXPECT_GT(sides, 0);
  run_command(controls, "heat on");
  draw(snapshot, controls);
  EXPECT_GT(vertices(), sides + 100);
}

TEST_F(PanelsTest, ColoursOfFibresAndTetsAreExplainedWhereThereAreSome) {
  const auto drawn = [this](Snapshot snapshot, const std::vector<std::string>& commands) {
    snapshot.compared.clear();
    Controls controls;
    for (const char* off : {"panels off", "hud off"}) run_command(controls, off);
    for (const std::string& command : commands) run_command(controls, command);
    draw(snapshot, controls);
    return vertices();
  };
  EXPECT_EQ(drawn(small_character(), {}), 0);
  const int fibres = drawn(small_character(), {"fibres on"}), tets = drawn(small_character(), {"tets on"});
  EXPECT_GT(fibres, 160) << "the bar";
  EXPECT_GT(tets, 12) << "three squares";
  EXPECT_EQ(drawn(small_character(), {"fibres on", "tets on"}), fibres + tets);
  EXPECT_EQ(drawn(small_character(), {"fibres on", "tets on", "legend off"}), 0);
  EXPECT_EQ(drawn(bare_character(), {"fibres on", "tets on"}), 0);
}

// A word while it is worked out; then the colours of tissues.
TEST_F(PanelsTest, TissuesOfASectionAreExplained) {
  Snapshot snapshot = small_character();
  snapshot.compared.clear();
  Controls controls;
  for (const char* off : {"panels off", "hud off"}) run_command(controls, off);
  draw(snapshot, controls);
  EXPECT_EQ(vertices(), 0);
  snapshot.section.emplace();
  draw(snapshot, controls);
  const int word = vertices();
  EXPECT_GT(word, 0);
  snapshot.section = SectionRow{true, {{"bone", {236, 228, 204}}, {"fat", {232, 196, 92}}}, ""};
  draw(snapshot, controls);
  const int colours = vertices();
  EXPECT_GT(colours, 0);
  EXPECT_NE(colours, word);
  snapshot.section->under_mouse = "biceps_l";
  for (int k = 0; k < 2; ++k) draw(snapshot, controls);
  EXPECT_GT(vertices(), colours);
}

TEST_F(PanelsTest, GoodNewsGoByThemselvesAndErrorsWhenTheyAreClicked) {
  const Snapshot snapshot = small_character();
  Controls controls;
  controls.panels = controls.settings.hud.on = controls.settings.hud.legend = false;
  controls.say("wrote a.png");
  controls.warn("it cannot be read");
  for (int k = 0; k < 60; ++k) draw(snapshot, controls);  // of a sixtieth of a second
  EXPECT_EQ(controls.messages.size(), 2u);
  for (int k = 0; k < 600; ++k) draw(snapshot, controls);
  ASSERT_EQ(controls.messages.size(), 1u);
  EXPECT_TRUE(controls.messages[0].error);
  click(snapshot, controls, rectangle_of("Messages").GetCenter());
  EXPECT_TRUE(controls.messages.empty());
}

// Beside the character, whatever is said.
TEST_F(PanelsTest, MessagesTakeRoomFromTheSidePanelAlone) {
  const Snapshot snapshot = small_character();
  Controls controls;
  Rectangle quiet, loud;
  for (int k = 0; k < 3; ++k) quiet = draw(snapshot, controls);
  const float before = rectangle_of("Side").GetHeight();
  const std::string name(300, 'x');
  for (int k = 0; k < 9; ++k) {
    controls.warn(name + " a long text that names a file and what was found in it, number " + std::to_string(k));
  }
  for (int k = 0; k < 3; ++k) loud = draw(snapshot, controls);
  EXPECT_EQ(loud.width, quiet.width);
  EXPECT_EQ(loud.height, quiet.height);
  const ImRect messages = rectangle_of("Messages"), side = rectangle_of("Side");
  EXPECT_GE(messages.Min.x, static_cast<float>(loud.x) + static_cast<float>(loud.width));
  EXPECT_NEAR(messages.Min.y, side.Max.y, 1);
  EXPECT_LT(side.GetHeight(), before);
  EXPECT_GT(side.GetHeight(), 0.5f * before);
  click(snapshot, controls, messages.GetCenter());
  EXPECT_TRUE(controls.messages.empty());
  draw(snapshot, controls);
  EXPECT_EQ(rectangle_of("Side").GetHeight(), before);
}

TEST_F(PanelsTest, PinsThatAreMissedAreSaid) {
  Snapshot snapshot = small_character();
  Controls controls;
  for (int k = 0; k < 3; ++k) draw(snapshot, controls);
  const int without = vertices();
  snapshot.missed_pins = {{"RightFoot", 34.6, true}};
  draw(snapshot, controls);
  EXPECT_GT(vertices(), without);
}

// A point is more pixels on a denser display; panels are laid out in points.
TEST_F(PanelsTest, TextIsAsLargeAsTheDisplaySays) {
  const Snapshot snapshot = small_character();
  Controls controls;
  std::map<float, ImDrawData> drawn;
  for (const float scale : {1.0f, 2.0f, 1.5f}) {
    for (int k = 0; k < 3; ++k) {
      gui_.begin(static_cast<std::uint32_t>(640 * scale), static_cast<std::uint32_t>(360 * scale), 1.0 / 60, scale);
      draw_panels(snapshot, controls, 640, 360);
      gui_.end();
    }
    EXPECT_NEAR(ImGui::GetFontSize(), 15, 0.01) << "points";
    EXPECT_NEAR(ImGui::GetFont()->FontSize, 15 * scale, 0.51) << "pixels";
    drawn[scale] = *ImGui::GetDrawData();
  }
  for (const float scale : {1.5f, 2.0f}) {
    EXPECT_EQ(drawn[scale].DisplaySize.x, 640);
    EXPECT_EQ(drawn[scale].FramebufferScale.x, scale);
    EXPECT_NEAR(drawn[scale].TotalVtxCount, drawn[1].TotalVtxCount, 0.02 * drawn[1].TotalVtxCount);
  }
}

TEST_F(PanelsTest, TheFrameNumberIsTypedInto) {
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

TEST_F(PanelsTest, TheTimelineTurnsRoundAndKeepsEveryFrame) {
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

TEST_F(PanelsTest, TheEndsOfTheRangeAreDragged) {
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

// Rows that change places cannot be read.
TEST_F(PanelsTest, MusclesKeepTheirPlacesWhileItPlays) {
  Snapshot snapshot = small_character();
  Controls controls = controls_with_all_open(snapshot);
  const auto order = [&] {
    draw(snapshot, controls);
    return controls.typed.fibre_order;
  };
  EXPECT_EQ(order(), (std::vector<std::size_t>{0, 1}));
  controls.playback.play();
  std::swap(snapshot.strains[0], snapshot.strains[1]);
  EXPECT_EQ(order(), (std::vector<std::size_t>{0, 1}));
  controls.playback.pause();
  EXPECT_EQ(order(), (std::vector<std::size_t>{1, 0}));
}

TEST_F(PanelsTest, LivePosesAndWhatWasRejectedAreSaid) {
  Snapshot snapshot = small_character();
  Controls controls;
  controls.panels = controls.settings.hud.legend = false;
  const auto drawn = [&] {
    draw(snapshot, controls);
    return vertices();
  };
  const int without = drawn();
  snapshot.live = LiveRow{12, 0, ""};
  const int with = drawn();
  EXPECT_GT(with, without + 40);
  snapshot.live->rejected = 3;
  snapshot.live->last_rejection = "it has 4 joints, expected 3";
  EXPECT_GT(drawn(), with + 100);
}

TEST_F(PanelsTest, ErrorsAreSaidToBeWithoutTheJiggle) {
  Snapshot snapshot = small_character();
  snapshot.compared = "truth";
  Controls controls;
  controls.settings.hud.on = controls.settings.hud.legend = false;
  run_command(controls, "section compare");
  const auto drawn = [&](const char* method) {
    snapshot.cast.at(0).method = method;
    for (int k = 0; k < 2; ++k) draw(snapshot, controls);
    return vertices();
  };
  EXPECT_GT(drawn("jiggle"), drawn("giggle") + 4 * 20);
}

TEST_F(PanelsTest, JointsThatAreTurnedAreCounted) {
  const Snapshot snapshot = small_character();
  Controls controls;
  controls.panels = controls.settings.hud.legend = false;
  const auto drawn = [&] {
    draw(snapshot, controls);
    return vertices();
  };
  const int none = drawn();
  controls.settings.pose.joints[snapshot.joints[0].name] = {};
  controls.settings.pose.joints["of another character"] = {1, 2, 3};
  EXPECT_EQ(drawn(), none);
  controls.settings.pose.joints[snapshot.joints[0].name] = {0, 0, 4};
  EXPECT_GT(drawn(), none + 4 * 2 * 10) << "1 joint turned";
}

TEST_F(PanelsTest, PanelsThatAreOnlyLookedAtChangeNothing) {
  const Snapshot snapshot = small_character();
  Controls controls = controls_with_all_open(snapshot);
  const ViewSettings before = controls.settings;
  for (int k = 0; k < 5; ++k) draw(snapshot, controls);
  EXPECT_EQ(controls.settings, before);
  EXPECT_EQ(controls.requests, Requests{});
  EXPECT_FALSE(controls.playback.playing());
}

TEST(Menus, HoldEveryCommandOnce) {
  std::map<std::string, int> commands_of;
  for (const Command& command : commands()) ++commands_of[command.menu];
  int total = 0;
  for (const char* menu : kMenus) {
    EXPECT_GT(commands_of[menu], 0) << menu;
    total += commands_of[menu];
  }
  EXPECT_EQ(total, static_cast<int>(commands().size()));
  EXPECT_EQ(std::set<std::string>(std::begin(kMenus), std::end(kMenus)).size(), std::size(kMenus));
}

TEST(Commands, OfTheSidePanelKnowItsSections) {
  std::vector<std::string> names;
  for (const Section& section : kSections) names.emplace_back(section.name);
  EXPECT_EQ(choices_of(*find_command("section")), names);
  Controls controls;
  run_command(controls, "section ghosts");
  for (const Section& section : kSections) {
    EXPECT_EQ(is_open(controls.settings, section), section.name == std::string("ghosts"));
  }
}

}  // namespace
}  // namespace bodyopt::testing
