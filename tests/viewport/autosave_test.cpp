// Nothing is lost: who leaves is asked, and what a crash left is brought back.
#include "viewport/state/autosave.h"

#include <imgui_internal.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>

#include "shots/session/session_file.h"
#include "tests/support/paths.h"
#include "tests/support/run_verb.h"
#include "tests/support/stand_in_human.h"
#include "tests/viewport/played_viewport.h"
#include "viewport/picking.h"
#include "viewport/scene/turn_rings.h"
#include "viewport/state/recent_files.h"

namespace bodyopt::testing {
namespace autosave_test {

using namespace shots;
using namespace viewport;

namespace fs = std::filesystem;

TEST(RecentFiles, AreTheLastOnceEach) {
  const TemporaryFolder folder;
  const RecentFiles recent(folder / "deeper/kept");
  EXPECT_TRUE(recent.list().empty());
  for (int k = 0; k < 12; ++k) recent.remember("/shots/" + std::to_string(k) + ".json");
  recent.remember("/shots/./5.json");
  const std::vector<std::string> files = recent.list();
  ASSERT_EQ(files.size(), RecentFiles::kMost);
  EXPECT_EQ(files[0], "/shots/5.json");
  EXPECT_EQ(files[1], "/shots/11.json");
  EXPECT_EQ(std::ranges::count(files, "/shots/5.json"), 1);
  RecentFiles nowhere("");
  nowhere.remember("/shots/1.json");
  EXPECT_TRUE(nowhere.list().empty());
}

TEST(Autosave, IsFoundOnceItsViewportHasEnded) {
  const TemporaryFolder folder;
  std::ofstream(folder / "notes.json") << "{}";
  Autosave later(folder.path());
  fs::path left;
  {
    Autosave earlier(folder.path());
    left = earlier.file();
    EXPECT_EQ(earlier.file(), left);
    std::ofstream(left) << "{\"a\": 1}";
    EXPECT_EQ(later.left_behind(), fs::path()) << "that of one which runs is its own";
  }
  EXPECT_EQ(later.left_behind(), left);
  EXPECT_NE(later.file(), left) << "a process of the same number does not write over it";
  later.take_over(left);
  EXPECT_FALSE(fs::exists(left));
  EXPECT_EQ(fs::file_size(later.file()), 8u);
  EXPECT_EQ(later.left_behind(), fs::path());
  EXPECT_THROW(later.take_over(left), Error) << "another took it meanwhile";
  later.forget();
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 1) << "notes.json";
  EXPECT_TRUE(Autosave("").file().empty());
}

// Killed, and its parent has not asked after it.
TEST(Autosave, IsFoundUnderAZombie) {
  const TemporaryFolder folder;
  const pid_t child = fork();
  if (child == 0) {
    Autosave own(folder.path());
    std::ofstream(own.file()) << "{}";
    raise(SIGKILL);
  }
  siginfo_t ended;
  waitid(P_PID, static_cast<id_t>(child), &ended, WEXITED | WNOWAIT);
  EXPECT_EQ(Autosave(folder.path()).left_behind(), folder / (std::to_string(child) + ".unsaved.json"));
  waitpid(child, nullptr, 0);
}

class LeavingTest : public PlayedTest {
 protected:
  ViewerOptions keeping() const {
    ViewerOptions options = small();
    options.user_folder = (folder_ / "kept").string();
    return options;
  }
  // Empty: there is none.
  fs::path autosave() const {
    std::error_code absent;
    for (const auto& entry : fs::directory_iterator(folder_ / "kept", absent)) {
      if (entry.path().string().ends_with(".unsaved.json")) return entry.path();
    }
    return {};
  }
  // The first of the buttons of a question, or the last.
  static void answer(PlayedViewport& viewport, bool first) {
    const ImRect question = ImGui::FindWindowByName("Question")->Rect();
    const float margin = 40;
    const double x = static_cast<double>(first ? question.Min.x + margin : question.Max.x - margin);
    viewport.click(x, static_cast<double>(question.Max.y) - 16);
  }
};

TEST_F(LeavingTest, IsAskedOnlyWhereSomethingWouldBeLost) {
  const auto calm = open(keeping(), "hud off; wire on");
  calm->key("Ctrl+Q");
  EXPECT_TRUE(calm->is_done()) << "looks alone are no work";
  const auto scripted = open(keeping(), "turn upper 20 0 0; key; quit");
  EXPECT_TRUE(scripted->is_done()) << "a script is not asked";
  const auto viewport = open(keeping(), "hud off");
  viewport->prompt("turn upper 20 0 0");
  viewport->key("Ctrl+Q");
  EXPECT_FALSE(viewport->is_done());
  EXPECT_TRUE(viewport->controls().asks_to_save);
  viewport->key("Escape");
  EXPECT_FALSE(viewport->controls().asks_to_save);
  viewport->play({CloseEvent{}});
  EXPECT_TRUE(viewport->controls().asks_to_save) << "the window's own button asks, too";
  answer(*viewport, false);
  EXPECT_FALSE(viewport->controls().asks_to_save || viewport->is_done());
  // Saved by name, and then by the key, it may go.
  viewport->prompt("save shot.json");
  viewport->prompt("turn upper 30 0 0");
  viewport->key("Ctrl+S");
  EXPECT_EQ(read_session("shot.json").view.pose.joints.at("upper"), (Vec3{30, 0, 0}));
  viewport->key("Ctrl+Q");
  EXPECT_TRUE(viewport->is_done());
}

TEST_F(LeavingTest, TheKeymapIsThatOfTheViewportBefore) {
  open(keeping(), "keymap maya");
  const auto viewport = open(keeping(), "hud off");
  EXPECT_EQ(viewport->controls().keymap, Keymap::maya);
  viewport->key("W");
  EXPECT_EQ(viewport->controls().tool, Tool::move);
  EXPECT_FALSE(viewport->controls().settings.look.wire);
  viewport->key("4");
  EXPECT_TRUE(viewport->controls().settings.look.wire);
  std::ofstream(folder_ / "kept" / "keymap.txt") << "houdini";
  ::testing::internal::CaptureStderr();
  EXPECT_EQ(open(keeping(), "hud off")->controls().keymap, Keymap::bodyopt);
  EXPECT_NE(::testing::internal::GetCapturedStderr().find("'houdini'"), std::string::npos);
}

TEST_F(LeavingTest, SavesAndLeavesWhereThatIsTheAnswer) {
  const auto viewport = open(keeping(), "hud off");
  viewport->prompt("save shot.json");
  viewport->prompt("turn upper 20 0 0");
  viewport->prompt("key");
  viewport->key("Ctrl+Q");
  answer(*viewport, true);
  EXPECT_TRUE(viewport->is_done());
  EXPECT_TRUE(read_session("shot.json").view.pose.keys.contains(1));
}

TEST_F(LeavingTest, WhatACrashLeftIsBroughtBack) {
  {
    const auto viewport = open(keeping(), "hud off");
    viewport->prompt("turn upper 20 0 0");
    viewport->prompt("key");
    EXPECT_FALSE(fs::exists(autosave()));
    viewport->let_pass(61);
    ASSERT_TRUE(fs::exists(autosave())) << "every minute";
    viewport->prompt("turn upper 40 0 0");
    viewport->prompt("key");
    viewport->prompt("export-clip take.glb");
    EXPECT_EQ(read_session(autosave()).view.pose.keys.at(1).joints.at("upper"), (Vec3{40, 0, 0})) << "before an export";
  }
  const fs::path left = autosave();
  EXPECT_EQ(open(keeping(), "hud off")->controls().recoverable, "") << "a script is not asked";
  const auto viewport = open(keeping(), "");
  ASSERT_EQ(viewport->controls().recoverable, left.string());
  const std::string of = fs::path(read_session(left).cast.front().files.basis).filename().string();
  EXPECT_EQ(viewport->controls().recoverable_what.rfind(of + ", 20", 0), 0u) << viewport->controls().recoverable_what;
  viewport->prompt("recover");
  EXPECT_EQ(viewport->controls().settings.pose.keys.at(1).joints.at("upper"), (Vec3{40, 0, 0}));
  EXPECT_FALSE(fs::exists(left));
  EXPECT_TRUE(fs::exists(autosave())) << "another crash would not lose it";
  viewport->key("Ctrl+Q");
  EXPECT_TRUE(viewport->controls().asks_to_save) << "it is in no session of the user's yet";
  viewport->key("Escape");
  viewport->prompt("save kept.json");
  EXPECT_FALSE(fs::exists(autosave()));
}

TEST_F(LeavingTest, WorkThatIsBroughtBackIsSavedWhereItWas) {
  {
    const auto viewport = open(keeping(), "hud off");
    viewport->prompt("save shot.json");
    viewport->prompt("turn upper 40 0 0");
    viewport->let_pass(61);
  }
  const auto viewport = open(keeping(), "");
  EXPECT_EQ(viewport->controls().recoverable_what.rfind("shot.json, 20", 0), 0u);
  viewport->prompt("recover");
  viewport->key("Ctrl+S");
  EXPECT_EQ(read_session("shot.json").view.pose.joints.at("upper"), (Vec3{40, 0, 0}));
}

TEST_F(LeavingTest, WhatASessionReplacesIsKept) {
  const auto viewport = open(keeping(), "hud off");
  viewport->prompt("save shot.json");
  viewport->prompt("turn upper 20 0 0");
  viewport->prompt("open shot.json");
  EXPECT_TRUE(viewport->controls().settings.pose.joints.empty());
  ASSERT_TRUE(fs::exists(autosave()));
  EXPECT_EQ(read_session(autosave()).view.pose.joints.at("upper"), (Vec3{20, 0, 0}));
  viewport->key("Ctrl+Q");
  EXPECT_TRUE(viewport->is_done());
  EXPECT_EQ(open(keeping(), "")->controls().recoverable, autosave().string());
}

// By mouse and keys: a squat over both feet, a wave that is copied and flipped, saved, more of it lost in a crash,
// brought back, exported.
TEST_F(LeavingTest, ASquatAndAWaveOutliveACrash) {
  write_character(stand_in_human(), "human.glb");
  ViewerOptions options = keeping();
  options.files = {"human.glb"};
  options.limits = kSourceFolder + "/rigs/human/limits.json";
  options.width = 640;
  options.height = 480;
  const auto clicked = [](PlayedViewport& viewport, const std::string& joint) {
    const Session& session = viewport.session();
    const int place = session.scene.lead().basis().skeleton.find(joint);
    const auto at = pixel_of(session.scene, viewport.controls(), {0, 0, 640, 480}, 320,
                             session.scene.joint_centres(viewport.controls())[static_cast<std::size_t>(place)]);
    viewport.click((*at)[0], (*at)[1]);
    EXPECT_EQ(viewport.controls().joint, joint);
  };
  std::map<int, ViewSettings::PoseKey> keys;
  {
    const auto viewport = open(options, kBarePicture + "; skeleton on; orbit 25 10");
    viewport->resize(640, 480);
    for (const char* foot : {"LeftFoot", "RightFoot"}) {
      clicked(*viewport, foot);
      viewport->prompt("pin");
    }
    viewport->key("Alt+K");
    viewport->key("Ctrl+C");
    viewport->prompt("frame 20");
    viewport->prompt("select Hips");
    const MoveArrow up = move_arrows(viewport->session().scene, viewport->controls()).at(1);
    const auto pixel = [&](double along) {
      return *pixel_of(viewport->session().scene, viewport->controls(), {0, 0, 640, 480}, 320,
                       up.from + along * (up.to - up.from));
    };
    viewport->drag(0, pixel(0.9), {pixel(0.4), pixel(-0.1)});
    EXPECT_LT(viewport->controls().settings.pose.moves.at("Hips")[1], -0.15);
    viewport->key("Alt+K");
    viewport->prompt("frame 40");
    viewport->key("Ctrl+V");
    viewport->prompt("turn RightArm 0 0 -50");
    viewport->key("Alt+K");
    viewport->key("Ctrl+C");
    viewport->prompt("frame 48");
    viewport->key("Ctrl+Shift+V");
    viewport->key("Alt+K");
    viewport->prompt("ease spline");
    EXPECT_TRUE(viewport->controls().settings.pose.keys.at(48).joints.contains("LeftArm"));
    EXPECT_FALSE(viewport->controls().settings.pose.keys.at(48).joints.contains("RightArm"));
    viewport->key("Ctrl+S");
    viewport->type("wave.json");
    viewport->key("Enter");
    EXPECT_EQ(read_session("wave.json").view.pose.keys.size(), 4u);
    viewport->prompt("frame 60");
    viewport->prompt("turn Head 0 20 0");
    viewport->key("Alt+K");
    keys = viewport->controls().settings.pose.keys;
    viewport->let_pass(61);
  }
  const auto viewport = open(options, "");
  ASSERT_NE(viewport->controls().recoverable, "");
  viewport->prompt("recover");
  EXPECT_TRUE(viewport->controls().settings.pose.keys == keys);
  viewport->key("Ctrl+S");
  EXPECT_TRUE(read_session("wave.json").view.pose.keys == keys);
  for (const char* command : {"in 1", "out 60", "export-skin take.pc2", "key", "save"}) viewport->prompt(command);
  const ProgramResult result = run_verb("eval --session wave.json --device cpu --out evaluated.pc2");
  ASSERT_EQ(result.exit_code, 0) << result.output;
  const Pc2Reader seen("take.pc2"), evaluated("evaluated.pc2");
  ASSERT_EQ(seen.sample_count(), 60u);
  const auto lowest = [&](std::uint32_t sample) {
    float low = 1e9f;
    const std::vector<float> points = seen.sample(sample);
    for (std::size_t k = 1; k < points.size(); k += 3) low = std::min(low, points[k]);
    return low;
  };
  for (std::uint32_t k = 0; k < 60; ++k) {
    EXPECT_NEAR(lowest(k), lowest(0), 0.02) << "feet stay on the ground in frame " << k + 1;
    const std::vector<float> a = seen.sample(k), b = evaluated.sample(k);
    for (std::size_t i = 0; i < a.size(); ++i) ASSERT_NEAR(a[i], b[i], 1e-5f) << k;
  }
}

// Nobody quits later because a name was refused now.
TEST_F(LeavingTest, ARefusedNameIsNoLeave) {
  const auto viewport = open(keeping(), "hud off");
  viewport->prompt("turn upper 20 0 0");
  viewport->key("Ctrl+Q");
  answer(*viewport, true);
  ASSERT_TRUE(viewport->controls().dialog);
  EXPECT_TRUE(viewport->controls().quits_when_saved);
  for (int k = 0; k < 12; ++k) viewport->key("Backspace");
  viewport->type("shot.txt");
  viewport->key("Enter");
  ASSERT_TRUE(viewport->controls().dialog) << "it can be mended";
  EXPECT_EQ(viewport->controls().dialog->name, "shot.txt");
  viewport->key("Escape");
  EXPECT_FALSE(viewport->controls().quits_when_saved);
}

TEST_F(LeavingTest, FilesThatWereOpenAreFoundAgain) {
  {
    const auto viewport = open(keeping(), "hud off");
    viewport->prompt("save shot.json");
  }
  const auto viewport = open(keeping(), "hud off");
  ASSERT_GE(viewport->controls().recent.size(), 2u);
  EXPECT_EQ(viewport->controls().recent[1], (folder_ / "shot.json").string());
  viewport->prompt("recent 2");
  EXPECT_EQ(viewport->controls().session_file, (folder_ / "shot.json").string());
  viewport->key("Ctrl+O");
  ASSERT_TRUE(viewport->controls().dialog);
  EXPECT_EQ(viewport->controls().dialog->command, "open");
}

// All heard at once, as after a stall.
TEST_F(LeavingTest, WhatWasTypedBeforeThePromptIsNoneOfIt) {
  const auto viewport = open(small(), kBarePicture);
  std::vector<WindowEvent> events{LetterEvent{'w'}};
  for (const WindowEvent& event : PlayedViewport::stroke("W")) events.push_back(event);
  for (const WindowEvent& event : PlayedViewport::stroke("Enter")) events.push_back(event);
  for (const char letter : std::string("frame 5")) events.emplace_back(LetterEvent{char32_t(letter)});
  for (const WindowEvent& event : PlayedViewport::stroke("Enter")) events.push_back(event);
  viewport->play(events);
  EXPECT_EQ(viewport->controls().playback.frame(), 5);
  EXPECT_TRUE(viewport->controls().settings.look.wire);
  EXPECT_TRUE(viewport->controls().messages.empty());
}

}  // namespace autosave_test
}  // namespace bodyopt::testing
