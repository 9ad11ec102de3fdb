// Keys, mouse, sizes, prompt, files: anything in any order, under Vulkan's validation. BODYOPT_TEST_SECONDS says for
// how long, BODYOPT_TEST_SEED which order.
#include <gtest/gtest.h>

#include "proxy_viewer/commands/commands.h"
#include "tests/proxy_viewer/window_fixture.h"
#include "tests/proxy_viewer/x_drag.h"
#include "tests/support/hostile_bytes.h"
#include "tests/support/random_tables.h"

namespace bodyopt::testing {
namespace {

double number_from_environment(const char* name, double otherwise) {
  const char* text = std::getenv(name);
  return text ? std::stod(text) : otherwise;
}

// As xdotool names them: of all commands but the one that ends the session.
std::vector<std::string> keys_of_commands() {
  std::vector<std::string> keys = {"Escape", "Delete", "BackSpace", "Page_Up", "Page_Down", "ctrl+a", "F11", "x"};
  for (const Command& command : commands()) {
    std::string key = command.key;
    if (key.empty() || std::string(command.name) == "quit") continue;
    if (key == "Enter") key = "Return";
    if (key == "Space") key = "space";
    for (const auto& [name, sent] : {std::pair("Ctrl+", "ctrl+"), {"Shift+", "shift+"}, {"Alt+", "alt+"}}) {
      if (key.starts_with(name)) key.replace(0, std::string(name).size(), sent);
    }
    if (key.size() == 1) key[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(key[0])));
    keys.push_back(key);
  }
  return keys;
}

const std::vector<std::string> kTyped = {"frame 5",
                                         "frame -2147483648",
                                         "step 2147483647",
                                         "frmae 3",
                                         "lead 2",
                                         "lead 3",
                                         "remove 1",
                                         "remove 2",
                                         "pan 100 -100",
                                         "wire maybe",
                                         "compare truth",
                                         "compare ddm",
                                         "compare linear",
                                         "compare jiggle",
                                         "compare none",
                                         "layout wipe",
                                         "wipe 0",
                                         "wipe 1",
                                         "heat-scale 0.001",
                                         "ghosts 12 12",
                                         "ghosts 0 0",
                                         "ghost-step 1000",
                                         "copies 7",
                                         "copies 1",
                                         "copy-delay 1000",
                                         "dolly 100",
                                         "dolly -100",
                                         "orbit 1e9 -1e9",
                                         "front",
                                         "tet-cut 1",
                                         "tet-cut 0",
                                         "level 15",
                                         "level auto",
                                         "select joint1",
                                         "turn joint1 360 -360 90",
                                         "turn joint0 0 0 0",
                                         "correction 0",
                                         "correction 1",
                                         "jiggle-amount 4",
                                         "mode ping-pong",
                                         "mode once",
                                         "speed 0.1",
                                         "speed 2",
                                         "every-frame",
                                         "in 12",
                                         "out 1",
                                         "whole-range",
                                         "section compare",
                                         "section cast",
                                         "section output",
                                         "save-camera a b",
                                         "camera a b",
                                         "forget-camera a b",
                                         "save-state s.json",
                                         "load-state s.json",
                                         "load-state none.json",
                                         "screenshot /nowhere/a.png",
                                         "sequence s.####.png",
                                         "sequence s.webp",
                                         "open none.bvh",
                                         "open bend.glb",
                                         "open limb.glb",
                                         "open truth.pc2",
                                         "кадр 5",
                                         "; ; #"};

class RandomInputTest : public WindowTest {
 protected:
  std::string below(std::uint32_t count) { return std::to_string(random_.below(count)); }
  const std::string& one_of(const std::vector<std::string>& all) {
    return all[random_.below(static_cast<std::uint32_t>(all.size()))];
  }
  std::string to_anywhere() { return "mousemove --window " + window_ + " " + below(700) + " " + below(500) + " "; }

  std::string any_drag() {
    const std::string button = std::to_string(1 + random_.below(5));
    const std::string held = one_of({"", "", "shift", "ctrl", "alt"});
    const std::string drag = to_anywhere() + "mousedown " + button + " " + to_anywhere() + "mouseup " + button + " ";
    return held.empty() ? drag : "keydown " + held + " " + drag + "keyup " + held + " ";
  }

  // One to eight things that hands do, as xdotool's commands. Typed text ends its chain.
  std::string any_hands() {
    std::string chain;
    for (std::uint32_t k = random_.below(8) + 1; k > 0; --k) {
      const std::uint32_t what = random_.below(20);
      if (what < 9) {
        chain += "key " + one_of(keys_) + " ";
      } else if (what < 14) {
        chain += any_drag();
      } else if (what == 14) {
        chain += to_anywhere() + "click --repeat 3 --delay 10 " + std::to_string(1 + random_.below(5)) + " ";
      } else if (what == 15) {
        const auto width = std::to_string(1 + random_.below(900)), height = std::to_string(1 + random_.below(700));
        chain += "windowsize " + window_ + " " + width + " " + height + " ";
      } else if (what == 16) {
        chain += "windowunmap " + window_ + " sleep 0." + below(4) + " windowmap " + window_ + " windowfocus " +
                 window_ + " ";
      } else if (what == 17) {
        chain += "sleep 0." + below(10) + " ";
      } else {
        return chain + "key Escape key Return sleep 0.1 type --delay 2 '" + one_of(kTyped) + "\n'";
      }
    }
    return chain;
  }

  // Bases are few: each is one more character on the stage.
  void drop_something() {
    const std::vector<std::string> files = {small_.clip,
                                            small_.truth,
                                            limb_.clip,
                                            (folder_ / "s.json").string(),
                                            (folder_ / "none").string(),
                                            limb_.clip,
                                            folder_.path().string(),
                                            small_.clip,
                                            small_.truth};
    std::vector<std::string> dropped;
    for (std::uint32_t k = random_.below(3) + 1; k > 0; --k) dropped.push_back(one_of(files));
    if (random_.below(12) == 0) dropped.push_back(limb_.basis);
    log_ = "drop of " + dropped.front();
    drag_->drop(dropped, std::stoul(window_), kPatience);
  }

  // A file is cut off, has other bytes, is away, or is again as it was.
  void change_a_file() {
    const std::string& path = one_of(changing_);
    std::string bytes = originals_.at(path);
    const std::uint32_t what = random_.below(5);
    log_ = "change " + std::to_string(what) + " of " + path;
    if (what == 0) {
      std::filesystem::remove(path);
      return;
    }
    if (what == 1) bytes.resize(random_.below(static_cast<std::uint32_t>(bytes.size())));
    if (what == 2) {
      for (int k = 0; k < 3; ++k) {
        bytes[random_.below(static_cast<std::uint32_t>(bytes.size()))] ^= static_cast<char>(1 + random_.below(255));
      }
    }
    write_bytes(path, bytes);
  }

  JigglingCharacter limb_{folder_};
  std::vector<std::string> changing_ = {small_.basis, small_.clip, small_.truth,
                                        limb_.basis,  limb_.clip,  (folder_ / "limb.dynamics.safetensors").string()};
  std::map<std::string, std::string> originals_;
  std::vector<std::string> keys_ = keys_of_commands();
  Random random_{static_cast<std::uint32_t>(number_from_environment("BODYOPT_TEST_SEED", 20260101))};
  std::string log_;
  std::unique_ptr<FileDrag> drag_;
};

TEST_F(RandomInputTest, DoesNoHarm) {
  for (const std::string& path : changing_) originals_[path] = read_bytes(path);
  drag_ = std::make_unique<FileDrag>(display_->name());
  const double seconds = number_from_environment("BODYOPT_TEST_SECONDS", 15);
  const std::string arguments = small(small_.truth + " " + limb_.basis + " " + limb_.clip + " --validate");
  const auto start = std::chrono::steady_clock::now();
  std::unique_ptr<BackgroundProgram> program;
  int turns = 0, sessions = 0;
  while (std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() < seconds) {
    if (!program || !program->runs()) {  // begins, or begins anew after a click on "quit"
      if (program) {
        ASSERT_EQ(program->wait(0), 0) << program->output() << "\nafter " << log_;
      }
      for (const auto& [path, bytes] : originals_) write_bytes(path, bytes);
      std::filesystem::remove(folder_ / "ready.png");
      program = open(arguments, "panels on; hud on");
      ++sessions;
    }
    const std::uint32_t what = random_.below(12);
    if (what == 0) {
      drop_something();
    } else if (what == 1) {
      change_a_file();
    } else {
      log_ = any_hands();
      display_->hands(log_);
    }
    ++turns;
  }
  EXPECT_GT(turns, 3);
  RecordProperty("turns", turns);
  RecordProperty("sessions", sessions);
  ASSERT_TRUE(program->runs()) << program->output() << "\nafter " << log_;
  display_->ask_to_close(window_);
  expect_end(*program, 0);
}

}  // namespace
}  // namespace bodyopt::testing
