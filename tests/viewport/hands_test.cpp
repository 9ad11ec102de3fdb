// The viewport as hands drive it: keys, mouse, text, sizes and files, in the loop that the program runs.
#include <gtest/gtest.h>

#include "tests/viewport/played_viewport.h"

namespace bodyopt::testing {
namespace {

using namespace draw;
using namespace viewport;

class HandsTest : public PlayedTest {};

TEST_F(HandsTest, WhatIsOnTheScreenIsTheScreenshot) {
  const auto viewport = open();
  const Image taken = screenshot(*viewport);
  EXPECT_TRUE(viewport->screen.picture.rgba == taken.rgba);
  EXPECT_NE(viewport->screen.title.find("small"), std::string::npos);
  viewport->key("Ctrl+Q");
  EXPECT_TRUE(viewport->is_done());
}

TEST_F(HandsTest, KeysDoWhatTheirCommandsDo) {
  const std::pair<std::vector<std::string>, const char*> steps[] = {
      {{"W"}, "wire on"},
      {{"W", "Right", "Right"}, "wire off; frame 3"},
      {{"End"}, "last"},
      {{"Home"}, "frame 1"},
      {{"Shift+Left", "K"}, "orbit-left; skeleton on"},
      {{"Shift+Right", "K", "Tab"}, "orbit-right; skeleton off; panels on"},
      {{"Tab", "1"}, "panels off; front"},
      {{"Ctrl+1"}, "back"},
      {{"3"}, "right"},
      {{"Ctrl+3"}, "left"},
      {{"7"}, "top"},
      {{"Ctrl+7"}, "bottom"}};
  std::vector<std::string> commands{"frame 1"};
  for (const auto& [keys, command] : steps) commands.emplace_back(command);
  const std::vector<Image> expected = headless_after_each(commands);
  EXPECT_FALSE(expected[1].rgba == expected[0].rgba);
  const auto viewport = open();
  EXPECT_TRUE(still(*viewport).rgba == expected[0].rgba);
  for (std::size_t k = 0; k < std::size(steps); ++k) {
    viewport->keys(steps[k].first);
    EXPECT_TRUE(still(*viewport).rgba == expected[k + 1].rgba) << steps[k].first.front();
  }
  viewport->key("H");
  EXPECT_FALSE(still(*viewport).rgba == expected.back().rgba);
  viewport->click(40, 165);  // which takes the sheet away
  EXPECT_TRUE(still(*viewport).rgba == expected.back().rgba);
  viewport->key("Space");
  viewport->let_pass(0.25);
  const int playing = viewport->controls().playback.frame();
  const Image earlier = viewport->screen.picture;
  viewport->turn({}, 0.125);
  EXPECT_NE(viewport->controls().playback.frame(), playing);
  EXPECT_FALSE(viewport->screen.picture.rgba == earlier.rgba);
  viewport->keys({"Space", "Home"});
  EXPECT_TRUE(still(*viewport).rgba == expected.back().rgba);
}

TEST_F(HandsTest, MouseTurnsMovesAndGoesNearer) {
  const Image turned = headless("orbit -45.8366 0"), nearer = headless("dolly 1");
  const auto viewport = open();
  const Image first = still(*viewport);
  const auto drag = [&](int button, double x, double y) {
    viewport->drag(button, {160, 60}, {{160 + x, 60 + y}});
    return still(*viewport);
  };
  // 45 pixels of 180, 3.2 radians across them, to the left.
  EXPECT_LT(spot_difference(drag(0, 45, 0), turned).mean, 0.05);
  EXPECT_LT(spot_difference(drag(0, -45, 0), first).mean, 0.05);
  EXPECT_GT(spot_difference(drag(2, 30, 10), first).mean, 1);
  EXPECT_LT(spot_difference(drag(2, -30, -10), first).mean, 0.05);
  viewport->play({ModifierKeysEvent{.shift = true}});
  EXPECT_GT(spot_difference(drag(0, 30, 10), first).mean, 1);
  viewport->play({ModifierKeysEvent{.shift = true}});
  EXPECT_LT(spot_difference(drag(0, -30, -10), first).mean, 0.05);
  viewport->play({WheelEvent{0, 1}});
  EXPECT_LT(spot_difference(still(*viewport), nearer).mean, 0.05);
  EXPECT_GT(spot_difference(drag(1, 30, 0), nearer).mean, 1);
}

// Steps go on, what turns round or writes does so once.
TEST_F(HandsTest, HeldKeysRepeatOnlyWhatGoesStepByStep) {
  const auto viewport = open();
  const auto hold = [&](const std::string& key) {
    viewport->play({KeyEvent{key, KeyAction::pressed}});
    for (int k = 0; k < 3; ++k) viewport->play({KeyEvent{key, KeyAction::repeated}});
    viewport->play({KeyEvent{key, KeyAction::released}});
  };
  hold("Right");
  EXPECT_EQ(viewport->controls().playback.frame(), 5);
  viewport->key("Home");
  hold("F12");
  EXPECT_TRUE(std::filesystem::exists("bodyopt.0001.png"));
  EXPECT_FALSE(std::filesystem::exists("bodyopt.0002.png"));
  hold("W");
  EXPECT_TRUE(viewport->controls().settings.look.wire);
}

// All at once, as a window that was busy hears it; or one event a picture. Two commands, one right after the other.
TEST_F(HandsTest, TypedCommandsRunHoweverFastTheyCome) {
  std::vector<WindowEvent> events;
  for (const std::string command : {"frame 5", "wire on"}) {
    for (const bool begins : {true, false}) {
      for (const WindowEvent& event : PlayedViewport::stroke("Enter")) events.push_back(event);
      for (const char letter : begins ? command : "") events.emplace_back(LetterEvent{char32_t(letter)});
    }
  }
  for (const bool at_once : {true, false}) {
    const auto viewport = open();
    if (at_once) viewport->play(events);
    for (const WindowEvent& event : at_once ? std::vector<WindowEvent>() : events) {
      viewport->turn({event}, PlayedViewport::kTurn);
    }
    viewport->rest();
    EXPECT_FALSE(viewport->controls().prompt) << at_once;
    EXPECT_TRUE(viewport->controls().messages.empty()) << at_once;
    EXPECT_EQ(viewport->controls().playback.frame(), 5) << at_once;
    EXPECT_TRUE(viewport->controls().settings.look.wire) << at_once;
    viewport->key("Right");
    EXPECT_EQ(viewport->controls().playback.frame(), 6) << "keys are heard again";
  }
}

// Twice as dense: the same picture of twice the size, where the mouse does the same.
TEST_F(HandsTest, OnADenserDisplayAllIsAsLarge) {
  const auto viewport = open(small(), "section cast; hud off");
  viewport->resize(640, 360);
  const auto joint_in_the_middle = [&](double scale) {
    viewport->click(scale * 0.5 * (640 - 216), scale * 150);
    const std::string joint = viewport->controls().joint;
    viewport->prompt("select");
    viewport->prompt("skeleton off");
    return joint;
  };
  viewport->prompt("frame-selection");
  const Image one = still(*viewport);
  const std::string joint = joint_in_the_middle(1);
  viewport->screen.density = 2;
  viewport->resize(1280, 720);
  viewport->prompt("frame-selection");
  const Image two = still(*viewport);
  Image halved{640, 360, std::vector<std::uint8_t>(one.rgba.size())};
  for (std::size_t y = 0; y < 360; ++y) {
    for (std::size_t x = 0; x < 4 * 640; ++x) {
      const std::size_t channel = x % 4, at = 4 * (2 * y * 1280 + 2 * (x / 4)) + channel, below = at + 4 * 1280;
      halved.rgba[y * 4 * 640 + x] =
          static_cast<std::uint8_t>((two.rgba[at] + two.rgba[at + 4] + two.rgba[below] + two.rgba[below + 4]) / 4);
    }
  }
  EXPECT_LT(spot_difference(halved, one).mean, 4);
  EXPECT_NE(joint, "");
  EXPECT_EQ(joint_in_the_middle(2), joint);
}

TEST_F(HandsTest, XShowsTheOtherForAsLongAsItIsHeld) {
  const std::string script = kBarePicture + "; legend off; frame 9; compare ddm; layout hold; heat off";
  const Image other = still(*open(small(), script + "; compare none; correction 0"));
  const auto viewport = open(small(), script);
  const Image shown = still(*viewport);
  ASSERT_GT(spot_difference(shown, other).mean, 0.05);
  viewport->play({KeyEvent{"X", KeyAction::pressed}});
  EXPECT_FALSE(viewport->screen.picture.rgba == shown.rgba);
  // Shift goes down while it is held, and up after it.
  viewport->play({ModifierKeysEvent{.shift = true}, KeyEvent{"Shift+X", KeyAction::released}, ModifierKeysEvent{}});
  EXPECT_TRUE(still(*viewport).rgba == shown.rgba);
}

// However few pictures are drawn between the letters: the prompt is opened, filled and entered.
TEST_F(HandsTest, QuickTypingIsHeard) {
  for (const std::size_t at_once : {1, 2, 3, 5, 20}) {
    std::vector<WindowEvent> events;
    const auto stroke = [&](const std::string& key, char letter) {
      events.emplace_back(KeyEvent{key, KeyAction::pressed});
      if (letter != 0) events.emplace_back(LetterEvent{static_cast<unsigned char>(letter)});
      events.emplace_back(KeyEvent{key, KeyAction::released});
    };
    stroke("Enter", 0);
    for (const char letter : std::string("frame 9")) {
      stroke(letter == ' ' ? "Space" : std::string(1, static_cast<char>(std::toupper(letter))), letter);
    }
    stroke("Enter", 0);
    const auto viewport = open();
    for (std::size_t k = 0; k < events.size(); k += at_once) {
      const auto first = events.begin() + static_cast<std::ptrdiff_t>(k);
      viewport->turn({first, first + static_cast<std::ptrdiff_t>(std::min(at_once, events.size() - k))}, 0.04);
    }
    viewport->rest();
    EXPECT_EQ(viewport->controls().playback.frame(), 9) << at_once;
    EXPECT_FALSE(viewport->controls().prompt) << at_once << " " << viewport->controls().typed.prompt;
  }
}

// Of a field, as it is filled, or of all that is typed at once. Letters are no keys of commands meanwhile.
TEST_F(HandsTest, FieldsAreCopiedAndPastedHoweverFastOneTypes) {
  for (const bool at_once : {false, true}) {
    const auto viewport = open();
    std::vector<WindowEvent> events;
    const auto stroke = [&](const std::string& name) {
      for (const WindowEvent& event : PlayedViewport::stroke(name)) events.push_back(event);
    };
    const auto letters = [&](const std::string& text) {
      for (const char letter : text) {
        stroke(std::string(1, static_cast<char>(std::toupper(letter))));
        events.insert(events.end() - 2, LetterEvent{char32_t(letter)});
      }
    };
    const auto play = [&] {
      if (at_once) viewport->play(events);
      for (const WindowEvent& event : at_once ? std::vector<WindowEvent>() : events) viewport->play({event});
      events.clear();
    };
    stroke("Enter");
    letters("wk");
    for (const char* key : {"Ctrl+A", "Ctrl+C", "End", "Ctrl+V"}) stroke(key);
    letters("b");
    play();
    EXPECT_EQ(viewport->controls().typed.prompt, "wkwkb") << at_once;
    stroke("Escape");
    play();
    EXPECT_FALSE(viewport->controls().prompt);
    stroke("Ctrl+S");
    letters("wk");
    for (const char* key : {"Ctrl+A", "Ctrl+X"}) stroke(key);
    letters("h");
    for (const char* key : {"Ctrl+V", "Ctrl+V"}) stroke(key);
    play();
    ASSERT_TRUE(viewport->controls().dialog);
    EXPECT_EQ(viewport->controls().dialog->name, "hwkwk") << at_once;
    letters(".json");
    stroke("Enter");
    stroke("W");
    play();
    EXPECT_FALSE(viewport->controls().dialog);
    EXPECT_EQ(std::filesystem::path(viewport->controls().session_file).filename(), "hwkwk.json") << at_once;
    EXPECT_TRUE(viewport->controls().settings.look.wire) << "keys are heard again";
    EXPECT_FALSE(viewport->controls().settings.look.skeleton || viewport->controls().cheat_sheet ||
                 viewport->controls().playback.backwards());
    EXPECT_FALSE(viewport->controls().copied);
  }
}

TEST_F(HandsTest, ErrorsFadeWhileNobodyDoesAnything) {
  const auto viewport = open();
  viewport->prompt("frame 99999");
  ASSERT_FALSE(viewport->controls().messages.empty());
  const Image told = viewport->screen.picture;
  viewport->let_pass(20);
  EXPECT_FALSE(viewport->controls().messages.empty());
  viewport->let_pass(20);
  EXPECT_TRUE(viewport->controls().messages.empty());
  EXPECT_FALSE(viewport->screen.picture.rgba == told.rgba);
}

// The middle of where two pictures differ.
std::array<double, 2> middle_of_difference(const Image& a, const Image& b) {
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
  return {static_cast<double>(sum[0] / count), static_cast<double>(sum[1] / count)};
}

TEST_F(HandsTest, AClickPicksAJointAndADragDoesNot) {
  const Image picked = headless("legend off; skeleton on; select upper");
  const auto viewport = open(small(), kBarePicture + "; legend off; skeleton on");
  const Image none = still(*viewport);
  const auto [x, y] = middle_of_difference(none, picked);
  viewport->drag(0, {x, y}, {{x + 60, y}, {x, y}});  // there and back: so is the camera
  const double apart = spot_difference(picked, none).largest;
  EXPECT_EQ(viewport->controls().joint, "");
  EXPECT_LT(spot_difference(still(*viewport), none).largest, 0.5 * apart);
  viewport->click(x, y);
  EXPECT_EQ(viewport->controls().joint, "upper");
  EXPECT_LT(spot_difference(still(*viewport), picked).largest, 0.5 * apart);
}

TEST_F(HandsTest, AClickOnTheSkinPicksTheNearestJointAndShowsThemAll) {
  const Image shown = headless("legend off; skeleton on"), picked = headless("legend off; skeleton on; select upper");
  const auto viewport = open(small(), kBarePicture + "; legend off");
  const Image none = still(*viewport);
  const auto [x, y] = middle_of_difference(shown, picked);
  viewport->click(10, 20);  // where no message is any more
  EXPECT_TRUE(still(*viewport).rgba == none.rgba) << "beside the skin";
  viewport->click(x, y);
  EXPECT_LT(spot_difference(still(*viewport), picked).largest, 0.5 * spot_difference(shown, picked).largest);
}

// Names in other scripts look as they are, whenever their files are opened.
TEST_F(HandsTest, NamesInOtherScriptsAreShownWhenTheirFilesAreOpenedLater) {
  const std::string names[] = {"\xd1\x82\xd0\xb0\xd0\xbd\xd0\xb5\xd1\x86",  // Russian
                               "\xcf\x87\xce\xbf\xcf\x81\xcf\x8c\xcf\x82",  // Greek
                               "\xd5\xba\xd5\xa1\xd6\x80"};                 // Armenian
  std::vector<Image> images;
  for (const std::string& name : names) {
    Clip clip = bending_clip(small_.made.skeleton);
    clip.name = name;
    const std::string file = name + ".glb", look = "panels on; section cast; frame 3";
    write_clip(clip, small_.made.skeleton, file);
    ViewerOptions options = small();
    options.width = 1000;
    options.height = 600;
    ViewerOptions at_start = options;
    at_start.files = {small_.basis, file};
    images.push_back(headless(at_start, look));
    ::testing::internal::CaptureStderr();
    EXPECT_TRUE(headless(options, look + "; open " + file + "; frame 3").rgba == images.back().rgba) << name;
    const std::string said = ::testing::internal::GetCapturedStderr();
    EXPECT_EQ(said.find("font"), std::string::npos) << said;
  }
  EXPECT_FALSE(images[0].rgba == images[1].rgba);
  EXPECT_FALSE(images[1].rgba == images[2].rgba);
}

TEST_F(HandsTest, StateBringsCameraAndSettingsBack) {
  const Image saved = headless("frame 6; orbit 50 20; dolly 2; wire on; save-state s.json");
  EXPECT_GT(spot_difference(saved, headless("frame 6")).mean, 0.5);
  ViewerOptions options = small();
  options.current = 6;
  options.state = "s.json";
  EXPECT_TRUE(headless(options, "panels off").rgba == saved.rgba);
  EXPECT_TRUE(headless("frame 6; load-state s.json").rgba == saved.rgba);
}

TEST_F(HandsTest, ResizedAndHiddenItGoesOn) {
  const auto viewport = open();
  const Image first = still(*viewport);
  for (const auto& [width, height] :
       {std::pair(200u, 150u), {640u, 400u}, {2600u, 120u}, {37u, 20u}, {1u, 1u}, {900u, 700u}, {320u, 180u}}) {
    viewport->resize(width, height);
    const Image image = screenshot(*viewport);
    EXPECT_EQ(image.width, width);
    EXPECT_EQ(image.height, height);
  }
  viewport->key("Space");
  viewport->screen.pixels = {0, 0};
  for (int k = 0; k < 4; ++k) viewport->turn({}, 0.2);
  viewport->resize(320, 180);
  viewport->keys({"Space", "Home"});
  EXPECT_TRUE(still(*viewport).rgba == first.rgba);
}

TEST_F(HandsTest, SequencesAreWithoutPanelsAndTheScriptWaitsForThem) {
  // A camera that somebody moved is not framed anew, in whichever area the comparison begins.
  std::vector<std::string> each{"frame 9; dolly 1; compare ddm; frame 3"};
  for (int frame = 4; frame <= 6; ++frame) each.push_back("frame " + std::to_string(frame));
  each.emplace_back("frame 9; in 3; out 6; panels on");
  const std::vector<Image> expected = headless_after_each(each);
  const auto viewport = open(
      small(), "frame 9; dolly 1; compare ddm; in 3; out 6; sequence s.####.png; hud off; screenshot after.png; quit");
  EXPECT_TRUE(viewport->is_done());
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_TRUE(read_png("s.000" + std::to_string(3 + k) + ".png").rgba == expected[k].rgba) << k;
  }
  EXPECT_TRUE(read_png("after.png").rgba == expected[4].rgba);
}

TEST_F(HandsTest, EscapeStopsATurntable) {
  const auto viewport = open();
  const Image first = still(*viewport);
  viewport->key("Enter");
  viewport->type("turntable t.##.png");
  viewport->turn(PlayedViewport::stroke("Enter"), 0.02);
  for (int k = 0; k < 40 && !std::filesystem::exists("t.02.png"); ++k) viewport->turn({}, 0.02);
  viewport->key("Escape");
  EXPECT_TRUE(std::filesystem::exists("t.02.png"));
  EXPECT_FALSE(std::filesystem::exists("t.72.png"));
  EXPECT_TRUE(still(*viewport).rgba == first.rgba);
}

TEST_F(HandsTest, WhatCannotBeReadIsSaidAndTheSessionGoesOn) {
  const JigglingCharacter other(folder_);
  Pc2Writer writer("of another.pc2", 5, 1);
  writer.append(std::vector<float>(15));
  writer.close();
  const Image fifth = headless("frame 5");
  ::testing::internal::CaptureStderr();
  const auto viewport =
      open(small({"of another.pc2", other.clip, "none.bvh", "notes.txt"}),
           kBarePicture +
               "; open missing.pc2; frmae 3; wire maybe; load-state none.json; screenshot /nowhere/a.png; frame 5");
  viewport->play({DropEvent{{"dropped.pc2"}}});
  EXPECT_TRUE(still(*viewport).rgba == fifth.rgba);
  const std::string output = ::testing::internal::GetCapturedStderr();
  for (const char* said : {"of another.pc2: the cache has 5 points", "joint0", "none.bvh: no such file",
                           "notes.txt: expected a basis", "missing.pc2", "nearest is 'frame'",
                           "'maybe' is not one of off on", "none.json", "/nowhere/a.png", "dropped.pc2"}) {
    EXPECT_NE(output.find(said), std::string::npos) << said << " is not in\n" << output;
  }
}

TEST_F(HandsTest, FilesThatChangeAreReadAgain) {
  const Image without = headless("frame 8; correction 0");
  const auto viewport = open(small(), kBarePicture + "; frame 8");
  const Image before = still(*viewport);
  EXPECT_GT(spot_difference(before, without).mean, 0.05);
  Basis changed = small_.made;
  std::fill(changed.residual.weights.begin(), changed.residual.weights.end(), 0.0f);
  save_basis(changed, small_.basis);
  viewport->let_pass(1.5);
  EXPECT_TRUE(still(*viewport).rgba == without.rgba);
  save_basis(small_.made, small_.basis);
  viewport->let_pass(1.5);
  EXPECT_TRUE(still(*viewport).rgba == before.rgba);
}

// Files that are cut off while they are shown.
TEST_F(HandsTest, DamagedFilesLeaveWhatWasThere) {
  const Image third = headless("frame 3; frame-selection");
  const auto viewport = open(small({small_.truth}), kBarePicture + "; compare truth; layout overlay");
  const Image before = still(*viewport);
  ::testing::internal::CaptureStderr();
  std::filesystem::resize_file(small_.basis, std::filesystem::file_size(small_.basis) / 2);
  viewport->let_pass(1.5);
  EXPECT_NE(::testing::internal::GetCapturedStderr().find("small.safetensors"), std::string::npos);
  EXPECT_TRUE(still(*viewport).rgba == before.rgba);
  // The truth is cut off: frames beyond are gone, it is said, and it is compared no longer.
  ::testing::internal::CaptureStderr();
  std::filesystem::resize_file(small_.truth, 100);
  viewport->keys({"Right", "Right"});
  EXPECT_NE(::testing::internal::GetCapturedStderr().find("truth.pc2"), std::string::npos);
  viewport->key("F");
  EXPECT_TRUE(still(*viewport).rgba == third.rgba);
}

}  // namespace
}  // namespace bodyopt::testing
