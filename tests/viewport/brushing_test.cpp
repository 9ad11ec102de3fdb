// Brushes on the skin of a dataset, by mouse and by script.
#include "viewport/brushing.h"

#include <chrono>

#include "dataset/modifier.h"
#include "runtime/core/atomic_file.h"
#include "tests/curate/curated_limb.h"
#include "tests/support/error_kind.h"
#include "tests/support/read_bytes.h"
#include "tests/viewport/played_viewport.h"
#include "trainer/curate/edit_stack.h"

namespace bodyopt::testing {
namespace {

using namespace trainer;
using namespace shots;
using namespace draw;
using namespace viewport;

// The limb lies along z: from its side, with the elbow in the middle.
const std::string kFromTheSide = kBarePicture + "; right; brush-radius 60; brush-strength 1; layout hold; frame 6";

class BrushingTest : public PlayedTest {
 protected:
  ViewerOptions dataset() const {
    ViewerOptions options;
    options.files = {limb_.folder().string()};
    options.width = 320;
    options.height = 180;
    return options;
  }
  void headless(const std::string& script) const {
    ViewerOptions own = dataset();
    own.headless = true;
    own.commands = kFromTheSide + "; " + script;
    Application(own, device_, nullptr).make_pictures();
  }
  std::vector<Modifier> modifiers() const { return read_dataset(limb_.path()).modifiers; }
  // How far the dataset's shape of frame 6 is from what it was before any modifier, mm.
  double moved_mm() const {
    const ShapeStack stack = limb_.stack();
    return 1e3 * (stack.shape(5) - stack.database().raw_shape(5)).rowwise().norm().maxCoeff();
  }
  std::string bytes() const { return read_bytes(limb_.path()); }

  CuratedLimb limb_;
};

TEST_F(BrushingTest, AScriptedStrokeIsASculptThatIsUndone) {
  headless("brush grab; stroke 0.5 0.5 0.5 0.4");
  ASSERT_EQ(modifiers().size(), 1u);
  EXPECT_EQ(modifiers()[0].type, "sculpt");
  EXPECT_EQ(modifiers()[0].parameters["sculpts"][0]["frame"], 6);
  EXPECT_GT(moved_mm(), 5);
  const double pulled = moved_mm();
  headless("brush erase; brush-radius 400; stroke 0.5 0.5 0.52 0.5 0.48 0.5; undo-edit; redo-edit");
  EXPECT_LT(moved_mm(), 0.9 * pulled);
  headless("undo-edit; undo-edit");
  EXPECT_TRUE(modifiers().empty());
  EXPECT_EQ(moved_mm(), 0);
}

TEST_F(BrushingTest, EveryBrushMovesTheSkin) {
  headless("brush grab; stroke 0.5 0.5 0.5 0.4");
  for (const char* brush : {"smooth", "inflate", "flatten", "erase"}) {
    const Positions before = limb_.stack().shape(5);
    headless(std::string("brush ") + brush + "; stroke 0.45 0.5 0.55 0.5");
    EXPECT_GT((limb_.stack().shape(5) - before).norm(), 1e-4) << brush;
  }
}

TEST_F(BrushingTest, WhatCannotBeBrushedIsRefusedAndNothingIsWritten) {
  const std::string before = bytes();
  for (const char* script : {"brush grab; stroke 0.02 0.02 0.5 0.5", "brush grab; raw on; stroke 0.5 0.5",
                             "stroke 0.5 0.5", "brush grab; stroke nan 0.5"}) {
    EXPECT_EQ(kind_of([&] { headless(script); }), ErrorKind::usage) << script;
  }
  EXPECT_EQ(bytes(), before);
}

TEST_F(BrushingTest, NothingIsWrittenBeforeTheMouseIsReleased) {
  const auto viewport = open(dataset(), kFromTheSide + "; brush grab");
  const std::string before = bytes();
  const Image first = still(*viewport);
  viewport->play({viewport->at(160, 90)});
  viewport->play({ButtonEvent{0, true}});
  for (const double y : {85.0, 80.0, 72.0}) viewport->play({viewport->at(160, y)});
  EXPECT_EQ(bytes(), before);
  EXPECT_GT(spot_difference(viewport->screen.picture, first).mean, 0.2) << "it is seen";
  const CurationRow& row = *viewport->session().snapshot.curation;
  EXPECT_EQ(row.legend, "hottest: takes all of the stroke");
  EXPECT_FLOAT_EQ(row.dots[5].heat, 1);
  EXPECT_FLOAT_EQ(row.dots[35].heat, 1) << "the same pose on the way back";
  EXPECT_GT(row.dots[4].heat, 0.5f);
  EXPECT_EQ(row.dots[20].heat, 0);
  const Positions drawn = limb_.stack().shape(5);
  viewport->play({ButtonEvent{0, false}});
  EXPECT_EQ(modifiers().size(), 1u);
  EXPECT_GT((limb_.stack().shape(5) - drawn).norm(), 1e-3);
  viewport->key("Ctrl+Z");
  EXPECT_TRUE(modifiers().empty());
  EXPECT_EQ(moved_mm(), 0);
  viewport->key("Ctrl+Shift+Z");
  EXPECT_EQ(modifiers().size(), 1u);
}

// Slowly or in one leap: the same touches.
TEST_F(BrushingTest, AStrokeIsTheSameHoweverFastTheMouseIs) {
  std::vector<Positions> shapes;
  for (const int steps : {1, 12}) {
    const auto viewport = open(dataset(), kFromTheSide + "; brush inflate; brush-radius 30");
    std::vector<std::array<double, 2>> over;
    for (int k = 1; k <= steps; ++k) over.push_back({140 + 40.0 * k / steps, 90});
    viewport->drag(0, {140, 90}, over);
    shapes.push_back(limb_.stack().shape(5));
    undo_modifiers(limb_.path());
  }
  EXPECT_GT((shapes[0] - limb_.truth(0, 6)).norm(), 1e-3);
  EXPECT_LT((shapes[0] - shapes[1]).cwiseAbs().maxCoeff(), 1e-6);
}

TEST_F(BrushingTest, BesideTheSkinTheMouseTurnsTheView) {
  const auto viewport = open(dataset(), kFromTheSide + "; brush grab");
  const std::string before = bytes();
  const OrbitView view = viewport->controls().camera.view();
  viewport->drag(0, {8, 8}, {{40, 8}});
  EXPECT_NE(viewport->controls().camera.view(), view);
  EXPECT_EQ(bytes(), before);
  viewport->prompt("brush none");
  viewport->drag(0, {160, 90}, {{160, 80}});
  EXPECT_EQ(bytes(), before);
}

TEST_F(BrushingTest, WhatCannotBeWrittenStaysInHand) {
  const auto viewport = open(dataset(), kFromTheSide + "; brush grab");
  const auto stroke = [&] { viewport->drag(0, {160, 90}, {{160, 80}}); };
  {
    const FileLock lock = lock_to_change(limb_.path());
    stroke();
    ASSERT_FALSE(viewport->controls().messages.empty());
    EXPECT_NE(viewport->controls().messages.back().text.find("another process"), std::string::npos);
    viewport->click_messages_away();
    viewport->key("Right");
    stroke();  // on another frame: the first waits
    EXPECT_NE(viewport->controls().messages.back().text.find("keep-strokes"), std::string::npos);
    viewport->click_messages_away();
  }
  EXPECT_TRUE(modifiers().empty());
  viewport->prompt("keep-strokes");
  ASSERT_EQ(modifiers().size(), 1u);
  EXPECT_EQ(modifiers()[0].parameters["sculpts"].size(), 1u);
  EXPECT_GT(moved_mm(), 5);
}

TEST_F(BrushingTest, EditsWhileAnotherProcessEditsAreRefusedAtOnce) {
  add_modifier(limb_.path(), {.type = "inflate"});
  const auto viewport = open(dataset(), kFromTheSide);
  const std::string before = bytes();
  for (const char* command : {"strength inflate 0.5", "modifier inflate off", "undo-edit"}) {
    const FileLock lock = lock_to_change(limb_.path());
    const auto start = std::chrono::steady_clock::now();
    viewport->prompt(command);
    EXPECT_LT(std::chrono::steady_clock::now() - start, kPatienceForChanges / 2) << command;
    ASSERT_FALSE(viewport->controls().messages.empty()) << command;
    EXPECT_NE(viewport->controls().messages.back().text.find("another process"), std::string::npos);
    viewport->click_messages_away();
  }
  EXPECT_EQ(bytes(), before);
  viewport->prompt("undo-edit");
  EXPECT_TRUE(modifiers().empty());
}

}  // namespace
}  // namespace bodyopt::testing
