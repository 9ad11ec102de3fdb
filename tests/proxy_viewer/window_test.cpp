// The program as people use it: in a window of a display without a screen, by keys and mouse, and by scripts.
#include <gtest/gtest.h>

#include "tests/proxy_viewer/window_fixture.h"
#include "tests/proxy_viewer/x_drag.h"

namespace bodyopt::testing {
namespace {

TEST_F(WindowTest, ScriptsWriteTheSamePicturesWithAWindowAndWithout) {
  const std::string script =
      "frame 4; style matcap; screenshot a.png; frame 9; skeleton on; fibres on; orbit 30 10; screenshot b.png; "
      "compare ddm; layout wipe; ghosts 1 1; ghost-step 3; panels on; screenshot c.png; panels off; worst-frame; "
      "compare none; ghost-opacity 0.8; screenshot d.png; quit";
  std::vector<Image> images[2];
  for (const bool headless : {false, true}) {
    const ProgramResult result = run_program(command(
        small("--validate --do '" + kPlain + "; " + script + "'" + (headless ? " --headless" : " --seconds 60"))));
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

TEST_F(WindowTest, APictureWhoseSurfaceIsOutOfDateIsShownNonetheless) {
  const auto program = open(small(""), kPlain, misbehaving_device("OUT_OF_DATE=1"));
  click_messages_away();
  EXPECT_TRUE(comes_true([&] { return display_->picture(window_).rgba == picture("ready.png").rgba; }, kPatience));
  display_->hands("key ctrl+q");
  expect_end(*program, 0);
}

TEST_F(WindowTest, KeysDoWhatTheirCommandsDo) {
  const std::pair<const char*, const char*> steps[] = {
      {"w", "wire on"},
      {"w key Right key Right", "wire off; frame 3"},
      {"End", "last"},
      {"Home", "frame 1"},
      {"shift+Left key k", "orbit-left; skeleton on"},
      {"shift+Right key k key Tab", "orbit-right; skeleton off; panels on"},
      {"Tab key 1", "panels off; front"},
      {"ctrl+1", "back"},
      {"3", "right"},
      {"ctrl+3", "left"},
      {"7", "top"},
      {"ctrl+7", "bottom"}};
  std::vector<std::string> commands{"frame 1"};
  for (const auto& [keys, command] : steps) commands.push_back(command);
  const std::vector<Image> expected = headless_after_each(commands);
  EXPECT_FALSE(expected[1].rgba == expected[0].rgba);
  const auto program = open(small("--validate"));
  const Image first = picture("ready.png");
  EXPECT_TRUE(first.rgba == expected[0].rgba);
  for (std::size_t k = 0; k < std::size(steps); ++k) {
    display_->hands(std::string("key ") + steps[k].first);
    EXPECT_TRUE(screenshot().rgba == expected[k + 1].rgba) << steps[k].first;
  }
  display_->hands("key h");
  EXPECT_FALSE(screenshot().rgba == expected.back().rgba);  // and clicks the sheet away
  EXPECT_TRUE(screenshot().rgba == expected.back().rgba);
  display_->hands("key space sleep 0.4");
  const Image playing = screenshot();
  EXPECT_TRUE(comes_true([&] { return screenshot().rgba != playing.rgba; }, kPatience));
  display_->hands("key space key Home");
  EXPECT_TRUE(screenshot().rgba == expected.back().rgba);
  display_->hands("key ctrl+q");
  expect_end(*program, 0);
}

TEST_F(WindowTest, MouseTurnsMovesAndGoesNearer) {
  const auto program = open(small("--validate"));
  const Image first = picture("ready.png");
  const auto drag = [&](const std::string& button, int x, int y) {
    const std::string at = "mousemove --window " + window_ + " ";
    display_->hands(at + "160 60 mousedown " + button + " sleep 0.5 " + at + std::to_string(160 + x) + " " +
                    std::to_string(60 + y) + " sleep 0.5 mouseup " + button + " sleep 0.5");
  };
  drag("1", 45, 0);
  // 45 pixels of 180, 3.2 radians across them, to the left.
  EXPECT_LT(spot_difference(screenshot(), headless("orbit -45.8366 0")).mean, 0.05);
  drag("1", -45, 0);
  EXPECT_LT(spot_difference(screenshot(), first).mean, 0.05);
  drag("2", 30, 10);
  const Image moved = screenshot();
  EXPECT_GT(spot_difference(moved, first).mean, 1);
  drag("2", -30, -10);
  EXPECT_LT(spot_difference(screenshot(), first).mean, 0.05);
  display_->hands("click 4");
  EXPECT_LT(spot_difference(screenshot(), headless("dolly 1")).mean, 0.05);
  drag("3", 30, 0);
  EXPECT_GT(spot_difference(screenshot(), headless("dolly 1")).mean, 1);
  display_->ask_to_close(window_);
  expect_end(*program, 0);
}

// Held keys repeat as the display repeats them: steps go on, what turns round or writes does so once.
TEST_F(WindowTest, HeldKeysRepeatOnlyWhatGoesStepByStep) {
  const auto program = open(small(""));
  display_->hands("keydown Right sleep 1.5 keyup Right");
  EXPECT_FALSE(screenshot().rgba == headless("frame 2").rgba);
  display_->hands("key Home keydown F12 sleep 1.5 keyup F12");
  ASSERT_TRUE(written("bodyopt.0002.png"));
  click_messages_away();
  EXPECT_FALSE(std::filesystem::exists(folder_ / "bodyopt.0003.png"));
  display_->hands("key ctrl+q");
  expect_end(*program, 0);
}

TEST_F(WindowTest, XShowsTheOtherForAsLongAsItIsHeld) {
  const auto program = open(small(""), kPlain + "; legend off; frame 9; compare ddm; layout hold; heat off");
  const Image shown = picture("ready.png"), other = headless("frame 9; correction 0");
  ASSERT_GT(spot_difference(shown, other).mean, 0.05);
  display_->hands("keydown x");
  EXPECT_TRUE(comes_true([&] { return display_->picture(window_).rgba != shown.rgba; }, kPatience));
  // Shift goes down while it is held, and up after it.
  display_->hands("keydown shift keyup x keyup shift");
  EXPECT_TRUE(screenshot().rgba == shown.rgba);
  display_->hands("key ctrl+q");
  expect_end(*program, 0);
}

// The middle of where two pictures differ.
std::array<int, 2> middle_of_difference(const Image& a, const Image& b) {
  std::array<std::size_t, 2> sum{};
  std::size_t count = 0;
  for (std::size_t k = 0; k < a.rgba.size(); k += 4) {
    if (std::equal(&a.rgba[k], &a.rgba[k] + 3, &b.rgba[k])) continue;
    sum[0] += k / 4 % a.width;
    sum[1] += k / 4 / a.width;
    ++count;
  }
  EXPECT_GT(count, 0u);
  count = std::max<std::size_t>(1, count);
  return {static_cast<int>(sum[0] / count), static_cast<int>(sum[1] / count)};
}

TEST_F(WindowTest, AClickPicksAJointAndADragDoesNot) {
  const auto program = open(small(""), kPlain + "; legend off; skeleton on");
  const Image none = picture("ready.png"), picked = headless("skeleton on; select upper");
  const auto [x, y] = middle_of_difference(none, picked);
  const auto at = [&](int dx) {
    return "mousemove --window " + window_ + " " + std::to_string(x + dx) + " " + std::to_string(y) + " sleep 0.4 ";
  };
  click_messages_away();
  // There and back: so is the camera.
  display_->hands(at(0) + "mousedown 1 sleep 0.5 " + at(60) + at(0) + "mouseup 1 sleep 0.4");
  const Image dragged = screenshot();
  EXPECT_LT(spot_difference(dragged, none).largest, 0.5 * spot_difference(picked, none).largest);
  display_->hands(at(0) + "click 1 sleep 0.4");
  const Image clicked = screenshot();
  EXPECT_LT(spot_difference(clicked, picked).largest, 0.5 * spot_difference(picked, none).largest);
  display_->hands("key ctrl+q");
  expect_end(*program, 0);
}

TEST_F(WindowTest, AClickOnTheSkinPicksTheNearestJointAndShowsThemAll) {
  const auto program = open(small(""), kPlain + "; legend off");
  const Image none = picture("ready.png"), shown = headless("skeleton on"),
              picked = headless("skeleton on; select upper");
  const auto [x, y] = middle_of_difference(shown, picked);
  click_messages_away();
  display_->hands("mousemove --window " + window_ + " 10 20 sleep 0.4 click 1 sleep 0.4");
  EXPECT_TRUE(screenshot().rgba == none.rgba) << "beside the skin";
  display_->hands("mousemove --window " + window_ + " " + std::to_string(x) + " " + std::to_string(y) +
                  " sleep 0.4 click 1 sleep 0.4");
  EXPECT_LT(spot_difference(screenshot(), picked).largest, 0.5 * spot_difference(shown, picked).largest);
  display_->hands("key ctrl+q");
  expect_end(*program, 0);
}

// Names in other scripts look as they are, whenever their files are opened.
TEST_F(WindowTest, NamesInOtherScriptsAreShownWhenTheirFilesAreOpenedLater) {
  const std::string names[] = {"\xd1\x82\xd0\xb0\xd0\xbd\xd0\xb5\xd1\x86",  // Russian
                               "\xcf\x87\xce\xbf\xcf\x81\xcf\x8c\xcf\x82",  // Greek
                               "\xd5\xba\xd5\xa1\xd6\x80"};                 // Armenian
  const auto with_room = [this](const std::string& arguments) {
    std::string line = command(arguments + " --headless -o named.png");
    return line.replace(line.find("320 180"), 7, "1000 600");
  };
  std::vector<Image> images;
  for (const std::string& name : names) {
    Clip clip = bending_clip(small_.made.skeleton);
    clip.name = name;
    const std::string file = (folder_ / (name + ".glb")).string();
    write_clip(clip, small_.made.skeleton, file);
    const std::string look = "panels on; section cast; frame 3";
    const ProgramResult at_start = run_program(with_room(small_.basis + " " + file + " --do '" + look + "'"));
    EXPECT_EQ(at_start.exit_code, 0) << at_start.output;
    images.push_back(picture("named.png"));
    const ProgramResult later =
        run_program(with_room(small("--validate --do '" + look + "; open " + file + "; frame 3'")));
    EXPECT_EQ(later.exit_code, 0) << later.output;
    EXPECT_EQ(later.output.find("font"), std::string::npos) << later.output;
    EXPECT_TRUE(picture("named.png").rgba == images.back().rgba) << name;
  }
  EXPECT_FALSE(images[0].rgba == images[1].rgba);
  EXPECT_FALSE(images[1].rgba == images[2].rgba);
}

TEST_F(WindowTest, StateBringsCameraAndSettingsBack) {
  const Image saved = headless("frame 6; orbit 50 20; dolly 2; wire on; save-state s.json");
  std::filesystem::rename(folder_ / "headless.png", folder_ / "saved.png");
  EXPECT_GT(spot_difference(saved, headless("frame 6")).mean, 0.5);
  const ProgramResult result =
      run_program(command(small("--headless --cf 6 --state s.json --do 'panels off' -o again.png")));
  EXPECT_EQ(result.exit_code, 0) << result.output;
  EXPECT_TRUE(picture("again.png").rgba == saved.rgba);
  EXPECT_TRUE(headless("frame 6; load-state s.json").rgba == saved.rgba);
}

TEST_F(WindowTest, ResizedHiddenAndShownAgainItGoesOn) {
  const auto program = open(small("--validate"));
  for (const auto& [width, height] :
       {std::pair(200, 150), {640, 400}, {2600, 120}, {37, 20}, {1, 1}, {900, 700}, {320, 180}}) {
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

TEST_F(WindowTest, SequencesAreWithoutPanelsAndTheScriptWaitsForThem) {
  const std::string script =
      "frame 9; compare ddm; in 3; out 6; sequence s.####.png; hud off; screenshot after.png; quit";
  const ProgramResult result = run_program(command(small("--validate --do '" + script + "' --seconds 60")));
  ASSERT_EQ(result.exit_code, 0) << result.output;
  for (int frame = 3; frame <= 6; ++frame) {
    const Image seen = picture("s.000" + std::to_string(frame) + ".png");
    EXPECT_TRUE(seen.rgba == headless("frame 9; compare ddm; frame " + std::to_string(frame)).rgba) << frame;
  }
  EXPECT_TRUE(picture("after.png").rgba == headless("frame 9; compare ddm; in 3; out 6; panels on").rgba);
}

TEST_F(WindowTest, EscapeStopsATurntable) {
  const auto program = open(small(""));
  display_->hands("windowsize --sync " + window_ + " 900 700 key Return type --delay 1 'turntable t.##.png'");
  display_->hands("key Return");
  ASSERT_TRUE(written("t.02.png"));
  display_->hands("key Escape sleep 0.5 windowsize --sync " + window_ + " 320 180");
  EXPECT_TRUE(comes_true([&] { return screenshot().rgba == picture("ready.png").rgba; }, kPatience));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "t.72.png"));
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

TEST_F(WindowTest, WhatCannotBeReadIsSaidAndTheSessionGoesOn) {
  const JigglingCharacter other(folder_);
  const std::string of_another = (folder_ / "of another.pc2").string();
  Pc2Writer writer(of_another, 5, 1);
  writer.append(std::vector<float>(15));
  writer.close();
  const auto program = open(
      small("'" + of_another + "' " + other.clip + " none.bvh notes.txt"),
      kPlain + "; open missing.pc2; frmae 3; wire maybe; load-state none.json; screenshot /nowhere/a.png; frame 5");
  EXPECT_TRUE(picture("ready.png").rgba == headless("frame 5").rgba);
  const std::string output = program->output();
  for (const char* said :
       {"of another.pc2: the cache has 5 points", "joint0", "none.bvh: no such file", "notes.txt: expected a basis",
        "missing.pc2", "nearest is 'frame'", "'maybe' is not one of off on", "none.json", "/nowhere/a.png"}) {
    EXPECT_NE(output.find(said), std::string::npos) << said << " is not in\n" << output;
  }
  display_->hands("key ctrl+q");
  expect_end(*program, 0);
}

TEST_F(WindowTest, FilesThatChangeAreReadAgain) {
  const auto program = open(small("--validate"), kPlain + "; frame 8");
  const Image before = picture("ready.png"), without = headless("frame 8; correction 0");
  EXPECT_GT(spot_difference(before, without).mean, 0.05);
  Basis changed = small_.made;
  std::fill(changed.residual.weights.begin(), changed.residual.weights.end(), 0.0f);
  save_basis(changed, small_.basis);
  EXPECT_TRUE(comes_true([&] { return screenshot().rgba == without.rgba; }, kPatience));
  save_basis(small_.made, small_.basis);
  EXPECT_TRUE(comes_true([&] { return screenshot().rgba == before.rgba; }, kPatience));
  display_->hands("key ctrl+q");
  expect_end(*program, 0);
}

// Files that change, are cut off, and go away while they are played.
TEST_F(WindowTest, FilesAreReadAgainAndDamagedOnesLeaveWhatWasThere) {
  const std::string& basis = small_.basis;
  const auto program = open(small(small_.truth + " --validate"), kPlain + "; compare truth; layout overlay");
  const Image before = picture("ready.png"), third = headless("frame 3");
  const auto says = [&, before_damage = program->output().size()](const std::string& text) {
    return comes_true([&] { return program->output().find(text, before_damage) != std::string::npos; }, kPatience);
  };
  std::filesystem::resize_file(basis, std::filesystem::file_size(basis) / 2);
  EXPECT_TRUE(says("small.safetensors"));
  EXPECT_TRUE(screenshot().rgba == before.rgba);
  // The truth is cut off: frames beyond are gone, it is said, and it is compared no longer.
  std::filesystem::resize_file(small_.truth, 100);
  display_->hands("key Right key Right");
  EXPECT_TRUE(says("truth.pc2"));
  EXPECT_TRUE(screenshot().rgba == third.rgba);
  EXPECT_TRUE(program->runs());
  display_->hands("key ctrl+q");
  expect_end(*program, 0);
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
