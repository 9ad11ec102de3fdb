#include "tests/viewport/drawn_panels.h"

namespace bodyopt::testing {
namespace {

using namespace shots;
using namespace draw;
using namespace viewport;

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
