// `bodyopt view` as people use it: in a window of a display without a screen, by keys and mouse, and by scripts.
#pragma once

#include <gtest/gtest.h>

#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "tests/support/gpu_fixture.h"
#include "tests/support/paths.h"
#include "tests/support/png_file.h"
#include "tests/support/run_verb.h"
#include "tests/viewport/small_character.h"
#include "tests/viewport/x_display.h"

namespace bodyopt::testing {

inline const std::string kPlain = "panels off; hud off";
inline constexpr double kPatience = 60;  // seconds: machines are slow under sanitizers and beside other work

// The environment of a program whose device misbehaves as `setting` says (tests/support/device_loss_layer.cpp).
inline std::string misbehaving_device(const std::string& setting) {
  return "VK_LAYER_PATH=" + kDeviceLossLayer + " VK_INSTANCE_LAYERS=VK_LAYER_BODYOPT_device_loss BODYOPT_" + setting;
}

// Runs `view` with a character in a folder of its own, on lavapipe unless BODYOPT_TEST_DEVICE names another device.
class WindowTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    test_device();  // the driver, for the programs
    missing_ = XDisplay::missing();
    if (missing_.empty()) display_ = std::make_unique<XDisplay>();
  }
  static void TearDownTestSuite() { display_.reset(); }

  void SetUp() override {
    if (!missing_.empty()) GTEST_SKIP() << missing_;
    ASSERT_NE(display_->name(), ":");
  }

  static std::string view(const std::string& arguments) {
    const char* device = std::getenv("BODYOPT_TEST_DEVICE");
    const bool chosen = !device || arguments.find("--device") != std::string::npos;
    return "view --size 320 180 " + (chosen ? "" : "--device " + std::string(device)) + " " + arguments;
  }
  std::string command(const std::string& arguments, const std::string& environment = "") const {
    return "env -C " + folder_.path().string() + " DISPLAY=" + display_->name() + " " + environment + " " + kProgram +
           " " + view(arguments);
  }
  // Without a window, in this process.
  ProgramResult view_headless(const std::string& arguments) const {
    const WorkingFolder here(folder_.path());
    return run_verb(view("--headless " + arguments));
  }
  std::string small(const std::string& arguments) const { return small_.basis + " " + small_.clip + " " + arguments; }

  // Opens the window; returns once its first picture is written.
  std::unique_ptr<BackgroundProgram> open(const std::string& arguments, const std::string& script = kPlain,
                                          const std::string& environment = "") {
    auto program = std::make_unique<BackgroundProgram>(
        command(arguments + " --do '" + script + "; screenshot ready.png'", environment), folder_ / "output.txt");
    comes_true([&] { return std::filesystem::exists(folder_ / "ready.png") || !program->runs(); }, kPatience);
    EXPECT_TRUE(program->runs()) << program->output();
    window_ = display_->window("Bodyopt");
    EXPECT_NE(window_, "");
    display_->hands("windowfocus " + window_ + " mousemove --window " + window_ + " 160 90");
    return program;
  }
  bool written(const std::string& file) const {
    return comes_true([&] { return std::filesystem::exists(folder_ / file); }, kPatience);
  }
  draw::Image picture(const std::string& file) const { return read_png(folder_ / file); }
  void click_messages_away() const {
    display_->hands("mousemove --window " + window_ + " 40 165 sleep 0.3 click 1 sleep 0.3 mousemove --window " +
                    window_ + " 300 100");
  }
  // By F12, which numbers its files. Clicks the message away: the mouse shall not be over it.
  draw::Image screenshot() {
    char name[32];
    std::snprintf(name, sizeof(name), "bodyopt.%04d.png", ++screenshots_);
    display_->hands("key F12");
    EXPECT_TRUE(written(name));
    click_messages_away();
    return picture(name);
  }
  draw::Image headless(const std::string& script) {
    const ProgramResult result = view_headless(small("--do '" + kPlain + "; " + script + "' -o headless.png"));
    EXPECT_EQ(result.exit_code, 0) << result.output;
    return picture("headless.png");
  }
  // One verb draws them all, each after the scripts before it.
  std::vector<draw::Image> headless_after_each(const std::vector<std::string>& scripts) {
    std::string together = kPlain;
    for (std::size_t k = 0; k < scripts.size(); ++k) {
      together += "; " + scripts[k] + "; screenshot each" + std::to_string(k) + ".png";
    }
    const ProgramResult result = view_headless(small("--do '" + together + "; quit'"));
    EXPECT_EQ(result.exit_code, 0) << result.output;
    std::vector<draw::Image> images;
    for (std::size_t k = 0; k < scripts.size(); ++k) images.push_back(picture("each" + std::to_string(k) + ".png"));
    return images;
  }
  // How many submissions the program makes, start and all: how they are batched is its own affair.
  int submissions_of(const std::string& arguments) const {
    return count_submissions([&](const std::string& counting) { return run_program(command(arguments, counting)); });
  }
  struct DriverCalls {
    int submissions = 0, allocations = 0, buffers = 0, sets = 0;  // the last three: of memory, and made
    int most_unwaited = 0;                                        // submissions at once
  };
  // `run` runs a program with this before its command.
  template <typename Run>
  DriverCalls count_calls(const Run& run) const {
    const std::filesystem::path file = folder_ / "calls.txt";
    const ProgramResult result = run(misbehaving_device("COUNT_CALLS=" + file.string()));
    EXPECT_EQ(result.exit_code, 0) << result.output;
    DriverCalls calls;
    std::ifstream(file) >> calls.submissions >> calls.allocations >> calls.buffers >> calls.sets >> calls.most_unwaited;
    EXPECT_GT(calls.submissions, 0);
    return calls;
  }
  template <typename Run>
  int count_submissions(const Run& run) const {
    return count_calls(run).submissions;
  }
  void expect_end(BackgroundProgram& program, int exit_code) {
    EXPECT_EQ(program.wait(kPatience), exit_code) << program.output();
  }

  static inline std::string missing_;
  static inline std::unique_ptr<XDisplay> display_;
  TemporaryFolder folder_;
  SmallCharacter small_{folder_};
  std::string window_;
  int screenshots_ = 0;
};

}  // namespace bodyopt::testing
