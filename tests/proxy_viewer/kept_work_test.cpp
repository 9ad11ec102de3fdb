// Nothing is lost: who leaves is asked, and what a crash left is brought back.
#include "proxy_viewer/state/kept_work.h"

#include <imgui_internal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>

#include "shots/session/session_file.h"
#include "tests/proxy_viewer/played_viewport.h"

namespace bodyopt::testing {
namespace kept_work_test {

namespace fs = std::filesystem;

// Of a process that has ended.
fs::path left_in(const fs::path& folder) {
  const pid_t child = fork();
  if (child == 0) _exit(0);
  waitpid(child, nullptr, 0);
  return folder / (std::to_string(child) + ".unsaved.json");
}

TEST(KeptWork, RemembersTheLastFilesOnceEach) {
  const TemporaryFolder folder;
  const KeptWork kept(folder / "deeper/kept");
  EXPECT_TRUE(kept.recent().empty());
  for (int k = 0; k < 12; ++k) kept.remember("/shots/" + std::to_string(k) + ".json");
  kept.remember("/shots/./5.json");
  const std::vector<std::string> files = kept.recent();
  ASSERT_EQ(files.size(), KeptWork::kMostRecent);
  EXPECT_EQ(files[0], "/shots/5.json");
  EXPECT_EQ(files[1], "/shots/11.json");
  EXPECT_EQ(std::ranges::count(files, "/shots/5.json"), 1);
  KeptWork nowhere("");
  nowhere.remember("/shots/1.json");
  EXPECT_TRUE(nowhere.recent().empty());
  EXPECT_TRUE(nowhere.aside().empty());
}

TEST(KeptWork, FindsWhatIsOfNoProcessAnyMore) {
  const TemporaryFolder folder;
  const KeptWork kept(folder.path());
  std::ofstream(kept.aside()) << "{}";
  std::ofstream(folder / "99999999999.unsaved.json") << "{}";
  std::ofstream(folder / "notes.json") << "{}";
  EXPECT_EQ(kept.left_behind(), fs::path()) << "its own is not left, nor is what no process wrote";
  const fs::path left = left_in(folder.path());
  std::ofstream(left) << "{\"a\": 1}";
  EXPECT_EQ(kept.left_behind(), left);
  kept.take_over(left);
  EXPECT_FALSE(fs::exists(left));
  EXPECT_EQ(fs::file_size(kept.aside()), 8u);
  kept.forget();
  EXPECT_FALSE(fs::exists(kept.aside()));
}

// Killed, and its parent has not asked after it.
TEST(KeptWork, FindsWhatIsOfAZombie) {
  const TemporaryFolder folder;
  const pid_t child = fork();
  if (child == 0) _exit(0);
  siginfo_t ended;
  waitid(P_PID, static_cast<id_t>(child), &ended, WEXITED | WNOWAIT);
  const fs::path left = folder / (std::to_string(child) + ".unsaved.json");
  std::ofstream(left) << "{}";
  EXPECT_EQ(KeptWork(folder.path()).left_behind(), left);
  waitpid(child, nullptr, 0);
}

class LeavingTest : public PlayedTest {
 protected:
  ViewerOptions keeping() const {
    ViewerOptions options = small();
    options.kept = (folder_ / "kept").string();
    return options;
  }
  fs::path aside() const { return KeptWork(folder_ / "kept").aside(); }
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
  EXPECT_TRUE(viewport->controls().leaving);
  viewport->key("Escape");
  EXPECT_FALSE(viewport->controls().leaving);
  viewport->play({CloseEvent{}});
  EXPECT_TRUE(viewport->controls().leaving) << "the window's own button asks, too";
  answer(*viewport, false);
  EXPECT_FALSE(viewport->controls().leaving || viewport->is_done());
  // Saved by name, and then by the key, it may go.
  viewport->prompt("save shot.json");
  viewport->prompt("turn upper 30 0 0");
  viewport->key("Ctrl+S");
  EXPECT_EQ(read_session("shot.json").view.pose.joints.at("upper"), (Vec3{30, 0, 0}));
  viewport->key("Ctrl+Q");
  EXPECT_TRUE(viewport->is_done());
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
    EXPECT_FALSE(fs::exists(aside()));
    viewport->let_pass(61);
    ASSERT_TRUE(fs::exists(aside())) << "every minute";
    viewport->prompt("turn upper 40 0 0");
    viewport->prompt("key");
    viewport->prompt("export-clip take.glb");
    EXPECT_EQ(read_session(aside()).view.pose.keys.at(1).joints.at("upper"), (Vec3{40, 0, 0})) << "before an export";
  }
  const fs::path left = left_in(folder_ / "kept");
  fs::rename(aside(), left);
  EXPECT_EQ(open(keeping(), "hud off")->controls().left_behind, "") << "a script is not asked";
  const auto viewport = open(keeping(), "");
  ASSERT_EQ(viewport->controls().left_behind, left.string());
  viewport->prompt("recover");
  EXPECT_EQ(viewport->controls().settings.pose.keys.at(1).joints.at("upper"), (Vec3{40, 0, 0}));
  EXPECT_FALSE(fs::exists(left));
  EXPECT_TRUE(fs::exists(aside())) << "another crash would not lose it";
  viewport->key("Ctrl+Q");
  EXPECT_TRUE(viewport->controls().leaving) << "it is in no session of the user's yet";
  viewport->key("Escape");
  viewport->prompt("save kept.json");
  EXPECT_FALSE(fs::exists(aside()));
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

}  // namespace kept_work_test
}  // namespace bodyopt::testing
