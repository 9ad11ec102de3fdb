// What an animator does by the mouse alone: poses without a clip, sets keys, saves what is on the stage.
#include <imgui_internal.h>

#include "shots/session/posed_clip.h"
#include "tests/support/paths.h"
#include "tests/support/run_verb.h"
#include "tests/support/stand_in_human.h"
#include "tests/viewport/played_viewport.h"
#include "viewport/commands/commands.h"

namespace bodyopt::testing {
namespace animator_test {

using namespace shots;
using namespace draw;
using namespace viewport;

class AnimatorTest : public PlayedTest {
 protected:
  // Without a clip, in a window that has room for panels.
  std::unique_ptr<PlayedViewport> open_still(const std::string& script = "hud off") const {
    ViewerOptions options = small();
    options.files = {small_.basis};
    auto viewport = open(options, script);
    viewport->resize(1280, 800);
    viewport->click_messages_away();
    return viewport;
  }
  static ImRect window(const char* name) { return ImGui::FindWindowByName(name)->Rect(); }
  static bool is_shown(const char* name) {
    const ImGuiWindow* found = ImGui::FindWindowByName(name);
    return found && found->Active && !found->Hidden;
  }
  // Of the commands of a menu that is open, the middle of its line.
  static std::array<double, 2> item(const std::string& menu, const std::string& command) {
    std::vector<std::string> names;
    for (const Command& each : commands()) {
      if (each.menu == menu) names.emplace_back(each.name);
    }
    const auto at = static_cast<double>(std::ranges::find(names, command) - names.begin());
    const ImRect popup = window("##Menu_00");
    const double border = 7, line = (static_cast<double>(popup.GetHeight()) - 2 * border) / std::ssize(names);
    return {static_cast<double>(popup.Min.x) + 30, static_cast<double>(popup.Min.y) + border + (at + 0.5) * line};
  }
  // The upper of the two buttons beside the frame's number, the lower.
  static std::array<double, 2> key_button(bool upper) {
    const ImRect timeline = window("Timeline");
    return {440, static_cast<double>(timeline.Min.y) + (upper ? 20 : 44)};
  }
  static void click(PlayedViewport& viewport, const std::array<double, 2>& at) {
    viewport.click(at[0], at[1]);
    viewport.play({viewport.at(300, 100)});
  }
};

TEST_F(AnimatorTest, WithoutAClipTenSecondsAreThereToPose) {
  const auto viewport = open_still();
  EXPECT_EQ(viewport->controls().playback.first(), 1);
  EXPECT_EQ(viewport->controls().playback.last(), 240);
  viewport->prompt("turn upper 20 0 0");
  viewport->prompt("key");
  viewport->prompt("frame 200");
  viewport->prompt("turn upper 0 35 0");
  viewport->prompt("key");
  viewport->prompt("in 190");
  viewport->prompt("out 205");
  viewport->prompt("export-skin seen.pc2");
  viewport->prompt("save shot.json");
  const ProgramResult result = run_verb("eval --session shot.json --device cpu --out evaluated.pc2");
  ASSERT_EQ(result.exit_code, 0) << result.output;
  const Pc2Reader seen("seen.pc2"), evaluated("evaluated.pc2");
  ASSERT_EQ(evaluated.sample_count(), 16u);
  EXPECT_EQ(evaluated.start_frame(), seen.start_frame());
  for (const std::uint32_t k : {0u, 15u}) {
    const std::vector<float> a = seen.sample(k), b = evaluated.sample(k);
    for (std::size_t i = 0; i < a.size(); ++i) ASSERT_NEAR(a[i], b[i], 2e-6f);
  }
  EXPECT_NE(seen.sample(0), seen.sample(15));
}

TEST_F(AnimatorTest, KeysAreSetAndRemovedBesideTheFrame) {
  const auto viewport = open_still("hud off; turn upper 20 0 0");
  click(*viewport, key_button(true));
  ASSERT_TRUE(viewport->controls().settings.pose.keys.contains(1));
  click(*viewport, key_button(false));
  EXPECT_TRUE(viewport->controls().settings.pose.keys.empty());
}

TEST_F(AnimatorTest, IsToldWhatGoesWithTheFrame) {
  const auto viewport = open_still("hud off; turn upper 20 0 0; key; frame 100; turn upper 0 30 0");
  EXPECT_TRUE(viewport->controls().is_unkeyed());
  EXPECT_TRUE(viewport->controls().messages.empty());
  viewport->prompt("frame 120");
  ASSERT_FALSE(viewport->controls().messages.empty());
  EXPECT_NE(viewport->controls().messages.back().text.find("frame 100 had no key"), std::string::npos);
  const std::size_t said = viewport->controls().messages.size();
  viewport->prompt("frame 130");
  viewport->prompt("turn upper 0 10 0");
  viewport->prompt("key");
  viewport->prompt("frame 1");
  EXPECT_LE(viewport->controls().messages.size(), said) << "what has a key is not lost";
}

TEST_F(AnimatorTest, APickBringsThePoseIntoView) {
  const auto viewport = open_still();
  viewport->resize(1280, 560);
  const ImRect side = window("Side");
  viewport->click(0.5 * static_cast<double>(side.Min.x), 0.4 * 560);
  EXPECT_NE(viewport->controls().joint, "");
  EXPECT_GT(ImGui::FindWindowByName("Side")->Scroll.y, 100);
  EXPECT_TRUE(viewport->controls().typed.revealed_section.empty());
}

// One event at a time, as from a mouse that stands still between.
TEST_F(AnimatorTest, MenusOpenUnderAMouseThatStandsStillAndCloseByEscape) {
  const auto viewport = open_still();
  viewport->click(20, 10);
  EXPECT_TRUE(is_shown("##Menu_00"));
  viewport->key("Escape");
  EXPECT_FALSE(is_shown("##Menu_00"));
  viewport->click(20, 10);
  const float of_file = window("##Menu_00").Min.x;
  viewport->play({viewport->at(75, 10)});  // Playback
  EXPECT_TRUE(is_shown("##Menu_00"));
  EXPECT_GT(window("##Menu_00").Min.x, of_file);
}

// A mouse that is gone before the next picture, as on a slow device.
TEST_F(AnimatorTest, APressIsWhereItWasMade) {
  const auto quick = open(), slow = open();
  quick->drag(0, {160, 60}, {{205, 60}});
  slow->play({slow->at(160, 60), ButtonEvent{0, true}, slow->at(205, 60)});
  slow->play({ButtonEvent{0, false}});
  const double turned = quick->controls().camera.view().azimuth;
  EXPECT_NE(turned, open()->controls().camera.view().azimuth);
  EXPECT_NEAR(slow->controls().camera.view().azimuth, turned, 1e-9);
}

// Its hand holds a finger; a joint that ends no longer bone is pinned itself.
TEST_F(AnimatorTest, AFingersPinIsTheHands) {
  write_character(stand_in_human(), "human.glb");
  ViewerOptions options = small();
  options.files = {"human.glb"};
  const auto viewport = open(options, kBarePicture + "; pin LeftHandFinger1; pin RightFoot; pin LThumb 0.5 1 0");
  const std::map<std::string, Vec3>& pins = viewport->controls().settings.pose.pins;
  EXPECT_EQ(viewport->controls().joint, "LeftHand");
  EXPECT_TRUE(pins.contains("LeftHand"));
  EXPECT_TRUE(pins.contains("RightFoot"));
  EXPECT_TRUE(pins.contains("LThumb")) << "a point pins any joint";
  EXPECT_EQ(pins.size(), 3u);
}

// A file of the lead's rig with a motion is a clip, unless a character is asked for.
TEST_F(AnimatorTest, AnotherOfTheSameRigIsOpenedAsACharacterByName) {
  write_character(stand_in_human(), "human.glb");
  std::filesystem::copy_file("human.glb", "second.glb");
  ViewerOptions options = small();
  options.files = {"human.glb"};
  const auto viewport = open(options, kBarePicture);
  viewport->prompt("character second.glb");
  ASSERT_EQ(viewport->session().scene.cast().size(), 2u);
  EXPECT_EQ(viewport->session().scene.cast()[1]->name(), "second");
  const Message& news = viewport->controls().messages.back();
  EXPECT_NE(news.text.find("not trained"), std::string::npos);
  EXPECT_FALSE(news.error) << "nothing is wrong";
  EXPECT_EQ(viewport->session().scene.lead().name(), "human");
  // In another unit, and as it was posed.
  viewport->prompt("turn LeftArm 0 0 20");
  const double size = viewport->session().scene.lead().size();
  viewport->prompt("unit 0.01");
  EXPECT_NEAR(viewport->session().scene.lead().size(), 0.01 * size, 1e-4 * size);
  EXPECT_EQ(viewport->controls().settings.pose.joints.at("LeftArm"), (Vec3{0, 0, 20}));
  viewport->prompt("unit auto");
  EXPECT_NEAR(viewport->session().scene.lead().size(), size, 1e-6 * size);
}

TEST_F(AnimatorTest, FramingTheRangeSeesCopiesAndWhereItGoes) {
  const auto viewport = open_still("hud off; copies 8");
  viewport->prompt("select");
  viewport->prompt("frame-selection");
  const double still = viewport->controls().camera.view().distance;
  viewport->prompt("turn lower 0 0 90");
  viewport->prompt("key");
  viewport->prompt("frame 100");
  viewport->prompt("reset-pose");
  viewport->prompt("move lower 0 3 0");
  viewport->prompt("key");
  viewport->prompt("frame 1");
  viewport->prompt("select upper");
  viewport->key("Shift+F");
  EXPECT_GT(viewport->controls().camera.view().distance, 1.1 * still) << "of what comes, too, and not of a joint alone";
  EXPECT_EQ(viewport->controls().joint, "upper");
  viewport->prompt("select");
  viewport->prompt("copies 1");
  viewport->prompt("frame-selection");
  EXPECT_LT(viewport->controls().camera.view().distance, 0.7 * still) << "copies take room";
}

// Names, colours and figures have room of their own beside bodies that are framed, or are left out.
TEST_F(AnimatorTest, WhatStandsOverThePictureStandsOverNoBody) {
  write_character(stand_in_human(), "human.glb");
  ViewerOptions options = small();
  options.files = {"human.glb"};
  struct Size {
    std::uint32_t width, height;
    float density;
  };
  for (const char* layout : {"side-by-side", "overlay", "wipe"}) {
    for (const Size& size : {Size{420, 240, 1}, {640, 360, 1}, {960, 540, 1}, {840, 480, 2}}) {
      const auto viewport = open(options, "compare lbs; heat on; turn LeftArm 0 0 -40; layout " + std::string(layout));
      viewport->screen.density = size.density;
      viewport->resize(size.width, size.height);
      viewport->play({viewport->at(9, 0.3 * size.height)});
      viewport->prompt("frame-selection");
      viewport->prompt("dolly 0.001");  // framed by hand: it stays so
      const Image over = still(*viewport);
      for (const char* command : {"legend off", "hud off"}) viewport->prompt(command);
      const Image without = still(*viewport);
      for (const char* command : {"heat off", "style silhouette", "shadow off", "grid off"}) viewport->prompt(command);
      const Image bodies = still(*viewport);
      viewport->prompt("dolly -60");
      const Image far = still(*viewport);
      std::size_t covered = 0, stands = 0, body = 0;
      const bool has_side = static_cast<float>(size.width) >= 560 * size.density;
      const float side = has_side ? size.density * window("Side").Min.x : static_cast<float>(size.width);
      const float line = viewport->controls().settings.compare.layout == CompareLayout::wipe ? 0.5f * side : -9;
      for (std::size_t k = 0; k < over.rgba.size(); k += 4) {
        const auto x = static_cast<float>(k / 4 % size.width);
        if (x >= side || std::abs(x - line) < 3 * size.density) continue;  // the wipe's line goes through bodies
        const bool differs = !std::equal(&over.rgba[k], &over.rgba[k] + 3, &without.rgba[k]);
        const bool is_body = bodies.rgba[k] < 40 && far.rgba[k] > 120;
        body += is_body ? 1 : 0;
        stands += differs ? 1 : 0;
        covered += differs && is_body ? 1 : 0;
      }
      const std::string of = std::string(layout) + " " + std::to_string(size.width);
      EXPECT_GT(body, over.width * over.height / 400) << of;
      EXPECT_GT(stands, 500u) << of;
      EXPECT_EQ(covered, 0u) << of;
      if (const char* keep = std::getenv("BODYOPT_KEEP_PICTURES")) {
        write_png(over, keep + ("/" + of + ".png"));
        write_png(bodies, keep + ("/" + of + " bodies.png"));
      }
    }
  }
}

// What was framed is seen whole from another side; who went nearer by hand stays there.
TEST_F(AnimatorTest, AnotherSideIsFramed) {
  const auto viewport = open(small(), kBarePicture + "; legend off; top; frame-selection");
  const double from_above = viewport->controls().camera.view().distance;
  viewport->key("1");
  const OrbitView turned = viewport->controls().camera.view();
  EXPECT_NE(turned.distance, from_above);
  viewport->key("F");
  EXPECT_NEAR(viewport->controls().camera.view().distance, turned.distance, 1e-6);
  viewport->play({WheelEvent{0, 3}});
  const double near = viewport->controls().camera.view().distance;
  EXPECT_LT(near, turned.distance);
  viewport->key("7");
  EXPECT_EQ(viewport->controls().camera.view().distance, near);
}

TEST_F(AnimatorTest, ASessionIsSavedByTheMenuAndTheList) {
  const auto viewport = open_still("hud off; turn upper 20 0 0; key");
  viewport->click(20, 10);
  click(*viewport, item("File", "save"));
  ASSERT_TRUE(viewport->controls().dialog);
  EXPECT_EQ(viewport->controls().dialog->command, "save");
  EXPECT_EQ(viewport->controls().dialog->name, "session.json");
  const ImRect dialog = window("File");
  click(*viewport, {static_cast<double>(dialog.Min.x) + 100, static_cast<double>(dialog.Max.y) - 20});
  EXPECT_FALSE(viewport->controls().dialog);
  EXPECT_TRUE(std::filesystem::exists("session.json"));
}

TEST_F(AnimatorTest, NamesThatAreProposedAreFreeAndTaken) {
  Controls controls;
  std::ofstream("motion.glb") << "x";
  std::ofstream("turntable.0001.png") << "x";
  for (const std::string& command : browsed_commands()) {
    run_command(controls, "browse " + command);
    const std::string name = controls.dialog->name;
    EXPECT_EQ(name == "motion_2.glb", command == "export-clip") << name;
    EXPECT_EQ(name == "turntable_2.####.png", command == "turntable") << name;
    if (!writes_file(command)) {
      EXPECT_EQ(name, "") << command;
    } else {
      EXPECT_FALSE(controls.dialog->replaces()) << name;
      EXPECT_NO_THROW(run_command(controls, command + " " + name)) << name;
    }
  }
}

}  // namespace animator_test
}  // namespace bodyopt::testing
