// The program in a real window, of a display without a screen: what the display tells it, and what it shows there. What
// it makes of events is in hands_test.cpp.
#include <gtest/gtest.h>

#include "tests/viewport/window_fixture.h"
#include "tests/viewport/x_drag.h"

namespace bodyopt::testing {
namespace {

using namespace draw;

TEST_F(WindowTest, ScriptsWriteTheSamePicturesWithAWindowAndWithout) {
  const std::string script =
      "frame 4; style matcap; screenshot a.png; frame 9; skeleton on; fibres on; orbit 30 10; screenshot b.png; "
      "compare ddm; layout wipe; ghosts 1 1; ghost-step 3; panels on; screenshot c.png; panels off; worst-frame; "
      "compare none; ghost-opacity 0.8; screenshot d.png; quit";
  std::vector<Image> images[2];
  for (const bool headless : {false, true}) {
    const std::string arguments = small("--validate --do '" + kPlain + "; " + script + "'");
    const ProgramResult result =
        headless ? view_headless(arguments) : run_program(command(arguments + " --seconds 60"));
    ASSERT_EQ(result.exit_code, 0) << result.output;
    for (const char* file : {"a.png", "b.png", "c.png", "d.png"}) {
      images[headless].push_back(picture(file));
      EXPECT_EQ(images[headless].back().width, 320u);
      std::filesystem::remove(folder_ / file);
    }
  }
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_TRUE(images[0][k].rgba == images[1][k].rgba) << "picture " << k;
    EXPECT_GT(spot_difference(images[0][k], images[0][(k + 1) % 4]).mean, 0.3) << k;
  }
}

TEST_F(WindowTest, WhatIsOnTheScreenIsTheScreenshot) {
  const auto program = open(small(""));
  click_messages_away();
  EXPECT_TRUE(comes_true([&] { return display_->picture(window_).rgba == picture("ready.png").rgba; }, kPatience));
  display_->hands("key ctrl+q");
  expect_end(*program, 0);
}

// Each kind of event comes in as it should: keys that are held, too, a drag, and files.
TEST_F(WindowTest, TheDisplaysEventsAreHeard) {
  const std::vector<Image> expected = headless_after_each({"skeleton on; orbit -45.8366 0", "skeleton off; front"});
  const auto program = open(small("--validate"));
  const std::string at = "mousemove --window " + window_ + " ";
  display_->hands("key k " + at + "160 60 mousedown 1 sleep 0.3 " + at + "205 60 sleep 0.3 mouseup 1");
  EXPECT_LT(spot_difference(screenshot(), expected[0]).mean, 0.05);
  display_->hands("key k key 1 key Home keydown Right sleep 1 keyup Right");
  EXPECT_FALSE(screenshot().rgba == expected[1].rgba) << "it repeats";
  display_->hands("key Home");
  EXPECT_TRUE(screenshot().rgba == expected[1].rgba);
  EXPECT_TRUE(FileDrag(display_->name()).drop({(folder_ / "none.bvh").string()}, std::stoul(window_), kPatience));
  EXPECT_TRUE(
      comes_true([&] { return program->output().find("none.bvh: no such file") != std::string::npos; }, kPatience))
      << program->output();
  display_->hands("key ctrl+q");
  expect_end(*program, 0);
}

// As fast as hands that are none: two commands, one right after the other.
TEST_F(WindowTest, TypedCommandsRun) {
  const auto program = open(small(""));
  display_->hands("key Return type --delay 0 'frame 9'");
  display_->hands("key Return key Return type --delay 0 'screenshot typed.png'");
  display_->hands("key Return");
  EXPECT_TRUE(written("typed.png")) << program->output();
  EXPECT_TRUE(picture("typed.png").rgba == headless("frame 9").rgba);
  display_->hands("key ctrl+q");
  expect_end(*program, 0);
}

TEST_F(WindowTest, APictureWhoseSurfaceIsOutOfDateIsShownNonetheless) {
  const auto program = open(small(""), kPlain, misbehaving_device("OUT_OF_DATE=1"));
  click_messages_away();
  EXPECT_TRUE(comes_true([&] { return display_->picture(window_).rgba == picture("ready.png").rgba; }, kPatience));
  display_->hands("key ctrl+q");
  expect_end(*program, 0);
}

TEST_F(WindowTest, ResizedHiddenAndShownAgainItGoesOn) {
  const auto program = open(small("--validate"));
  for (const auto& [width, height] : {std::pair(640, 400), {1, 1}, {320, 180}}) {
    display_->hands("windowsize --sync " + window_ + " " + std::to_string(width) + " " + std::to_string(height));
    EXPECT_TRUE(comes_true(
        [&, w = width, h = height] {
          const Image image = screenshot();
          return image.width == static_cast<std::uint32_t>(w) && image.height == static_cast<std::uint32_t>(h);
        },
        kPatience))
        << width << " x " << height;
  }
  display_->hands("key space windowunmap " + window_ + " sleep 0.5 windowmap --sync " + window_);
  display_->hands("windowfocus " + window_ + " key space key Home");
  EXPECT_TRUE(screenshot().rgba == picture("ready.png").rgba);
  display_->hands("key ctrl+q");
  expect_end(*program, 0);
}

// Beyond what pictures can be, proportions are kept, and the mouse is where it is seen.
TEST_F(WindowTest, AWindowOfAnySizeIsFilled) {
  const auto program = open(small(""), kPlain + "; legend off");
  display_->hands("windowsize --sync " + window_ + " 10240 320 sleep 0.5");
  Image image;
  EXPECT_TRUE(comes_true([&] { return (image = screenshot()).width == 8192; }, kPatience));
  EXPECT_EQ(image.height, 256u);
  display_->hands("key ctrl+q");
  expect_end(*program, 0);
}

TEST_F(WindowTest, EndsWhileItLoadsOrPlays) {
  for (const int signal : {SIGINT, SIGTERM}) {
    const auto program = open(small(""), kPlain + "; play");
    program->send(signal);
    expect_end(*program, 75);
    EXPECT_NE(program->output().find("interrupted"), std::string::npos);
    std::filesystem::remove(folder_ / "ready.png");
  }
  BackgroundProgram early(command(small("")), folder_ / "early.txt");
  ASSERT_TRUE(comes_true([&] { return !(window_ = display_->window("Bodyopt")).empty(); }, kPatience));
  display_->ask_to_close(window_);
  expect_end(early, 0);
  const ProgramResult brief = run_program(command(small("--seconds 0.5 --do play")));
  EXPECT_EQ(brief.exit_code, 0) << brief.output;
}

TEST_F(WindowTest, GoesOnWhenTheWindowThatFilesAreDraggedFromGoesAway) {
  const auto program = open(small(""));
  FileDrag(display_->name()).vanish_over(std::stoul(window_));
  EXPECT_TRUE(comes_true([&] { return program->output().find("BadWindow") != std::string::npos; }, kPatience))
      << program->output();
  EXPECT_TRUE(screenshot().rgba == picture("ready.png").rgba);
  display_->hands("key ctrl+q");
  expect_end(*program, 0);
}

// The program is held at its first picture.
TEST_F(WindowTest, WhatIsReadIsSaidMeanwhile) {
  BackgroundProgram program(command(small(""), misbehaving_device("HOLD_FIRST_PICTURE=1")), folder_ / "output.txt");
  ASSERT_TRUE(comes_true([&] { return !(window_ = display_->window("Bodyopt")).empty(); }, kPatience))
      << program.output();
  EXPECT_TRUE(comes_true(
      [&] {
        const Image shown = display_->picture(window_);
        std::size_t letters = 0;  // pixels that are not as the first
        for (std::size_t k = 0; k < shown.rgba.size(); k += 4) {
          if (!std::equal(&shown.rgba[k], &shown.rgba[k] + 3, shown.rgba.data())) ++letters;
        }
        return letters > 100 && letters < shown.rgba.size() / 16;
      },
      kPatience));
  EXPECT_NE(program.output().find("loading " + small_.basis), std::string::npos) << program.output();
  EXPECT_TRUE(program.runs());
}

TEST_F(WindowTest, WithoutADisplayItSaysWhatToDo) {
  for (const char* display : {"DISPLAY=", "DISPLAY=:987"}) {
    const ProgramResult result = run_program(command(small(""), display));
    EXPECT_EQ(result.exit_code, 5) << result.output;
    EXPECT_NE(result.output.find("--headless"), std::string::npos) << result.output;
  }
}

TEST_F(WindowTest, WithoutADeviceItSaysWhatToInstall) {
  const std::string no_driver = "VK_DRIVER_FILES=/nowhere.json VK_ICD_FILENAMES=/nowhere.json";
  for (const char* how : {"", "--headless -o a.png"}) {
    const ProgramResult result = run_program(command(small(how), no_driver));
    EXPECT_EQ(result.exit_code, 5) << result.output;
    EXPECT_NE(result.output.find("mesa-vulkan-drivers"), std::string::npos) << result.output;
  }
}

TEST_F(WindowTest, WhatCannotBeginHasTheExitCodeOfItsReason) {
  const std::pair<std::string, int> cases[] = {{"none.safetensors", 4},
                                               {small_.clip, 64},
                                               {small("--do 'frmae 3' --headless -o a.png"), 64},
                                               {small("--state none.json"), 4},
                                               {small("none.bvh --headless -o a.png"), 4},
                                               {small("--device 'no such device'"), 5}};
  for (const auto& [arguments, exit_code] : cases) {
    const ProgramResult result = run_program(command(arguments));
    EXPECT_EQ(result.exit_code, exit_code) << arguments << "\n" << result.output;
    EXPECT_EQ(result.output.find("defect"), std::string::npos) << result.output;
  }
}

}  // namespace
}  // namespace bodyopt::testing
