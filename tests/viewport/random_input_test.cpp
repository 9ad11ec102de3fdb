// Keys, mouse, sizes, prompt, files: anything in any order, under Vulkan's validation. BODYOPT_TEST_TURNS says how
// much, BODYOPT_TEST_SEED which order.
#include <gtest/gtest.h>

#include "tests/support/hostile_bytes.h"
#include "tests/support/random_tables.h"
#include "tests/viewport/played_viewport.h"
#include "viewport/commands/commands.h"

namespace bodyopt::testing {
namespace {

using namespace viewport;

std::uint32_t number_from_environment(const char* name, std::uint32_t otherwise) {
  const char* text = std::getenv(name);
  return text ? static_cast<std::uint32_t>(std::stoul(text)) : otherwise;
}

// Of all commands but the one that ends the session.
std::vector<std::string> keys_of_commands() {
  std::vector<std::string> keys = {"Escape", "Delete", "Backspace", "PageUp", "PageDown", "Ctrl+A", "F11", "X"};
  for (const Command& command : commands()) {
    if (*command.key != 0 && std::string(command.name) != "quit") keys.emplace_back(command.key);
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
                                         "mark",
                                         "marker 1 2",
                                         "unmark",
                                         "place 2 3 0 -1",
                                         "place 2 auto",
                                         "ahead 2 -7",
                                         "ahead 2 auto",
                                         "level-of 2 15",
                                         "same-clip",
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

class RandomInputTest : public PlayedTest {
 protected:
  const std::string& one_of(const std::vector<std::string>& all) {
    return all[random_.below(static_cast<std::uint32_t>(all.size()))];
  }
  // Beside the window, too.
  WindowEvent to_anywhere() { return CursorEvent{random_.uniform(-0.3, 1.5), random_.uniform(-0.3, 1.5)}; }
  double any_time() { return random_.below(4) == 0 ? random_.uniform(0, 1) : PlayedViewport::kTurn; }

  void any_drag() {
    const int button = static_cast<int>(random_.below(5));
    const std::uint32_t held = random_.below(6);
    viewport_->turn({ModifierKeysEvent{held == 1, held == 2, held == 3}, to_anywhere(), ButtonEvent{button, true}},
                    any_time());
    viewport_->turn({to_anywhere()}, any_time());
    viewport_->turn({ButtonEvent{button, false}, ModifierKeysEvent{}}, any_time());
  }

  void any_hands() {
    const std::uint32_t what = random_.below(20);
    if (what < 9) {
      log_ = one_of(keys_);
      viewport_->turn(PlayedViewport::stroke(log_), any_time());
    } else if (what < 14) {
      any_drag();
    } else if (what == 14) {
      const int button = static_cast<int>(random_.below(5));
      const WindowEvent at = to_anywhere();
      for (int k = 0; k < 3; ++k) viewport_->turn({at, ButtonEvent{button, true}, ButtonEvent{button, false}}, 0.05);
      viewport_->turn({WheelEvent{0, random_.uniform(-3, 3)}}, any_time());
    } else if (what == 15) {
      viewport_->screen.pixels = {1 + random_.below(900), 1 + random_.below(700)};
      viewport_->turn({SurfaceEvent{}}, any_time());
    } else if (what == 16) {
      const auto shown = std::exchange(viewport_->screen.pixels, {0, 0});
      viewport_->turn({SurfaceEvent{}}, any_time());
      viewport_->screen.pixels = shown;
    } else if (what == 17) {
      viewport_->turn({}, random_.uniform(0, 1));
    } else {
      log_ = one_of(kTyped);
      for (const char* key : {"Escape", "Enter"}) viewport_->turn(PlayedViewport::stroke(key), any_time());
      for (const char letter : log_) {
        viewport_->turn({LetterEvent{static_cast<unsigned char>(letter)}}, PlayedViewport::kTurn);
      }
      viewport_->turn(PlayedViewport::stroke("Enter"), any_time());
    }
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
    DropEvent dropped;
    for (std::uint32_t k = random_.below(3) + 1; k > 0; --k) dropped.files.push_back(one_of(files));
    if (random_.below(12) == 0) dropped.files.push_back(limb_.basis);
    log_ = "drop of " + dropped.files.front();
    viewport_->turn({dropped}, any_time());
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
  Random random_{number_from_environment("BODYOPT_TEST_SEED", 20260101)};
  std::string log_;
  std::unique_ptr<PlayedViewport> viewport_;
};

TEST_F(RandomInputTest, DoesNoHarm) {
  for (const std::string& path : changing_) originals_[path] = read_bytes(path);
  ::testing::internal::CaptureStderr();  // of what is wrong on purpose
  const std::uint32_t turns = number_from_environment("BODYOPT_TEST_TURNS", 120);
  for (std::uint32_t k = 0; k < turns; ++k) {
    if (!viewport_ || viewport_->is_done()) {  // begins, or begins anew after a click on "quit"
      viewport_.reset();
      for (const auto& [path, bytes] : originals_) write_bytes(path, bytes);
      viewport_ = open(small({small_.truth, limb_.basis, limb_.clip}), "panels on; hud on");
    }
    const std::uint32_t what = random_.below(12);
    if (what == 0) {
      drop_something();
    } else if (what == 1) {
      change_a_file();
    } else {
      any_hands();
    }
    const auto messages = device_->validation_messages();
    ASSERT_TRUE(messages.empty()) << messages.front() << "\nafter " << log_;
  }
  viewport_.reset();
  const std::string said = ::testing::internal::GetCapturedStderr();
  EXPECT_EQ(said.find("defect"), std::string::npos) << said;
}

}  // namespace
}  // namespace bodyopt::testing
