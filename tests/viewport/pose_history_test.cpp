#include "viewport/state/pose_history.h"

#include <gtest/gtest.h>

#include "viewport/commands/commands.h"

namespace bodyopt::testing {
namespace {

using namespace shots;
using namespace viewport;

ViewSettings posing(double degrees) {
  ViewSettings settings;
  if (degrees != 0) settings.pose.joints["hip"] = {degrees, 0, 0};
  return settings;
}

TEST(PoseHistory, GoesBackAndForthStepByStep) {
  PoseHistory history;
  ViewSettings now = posing(1);
  history.note(now);
  history.note(now);  // nothing has changed
  now.pose.controls["breath"] = 0.5;
  history.note(now);
  ASSERT_TRUE(history.undo(now));
  EXPECT_EQ(now, posing(1));
  ASSERT_TRUE(history.undo(now));
  EXPECT_EQ(now, posing(0));
  EXPECT_FALSE(history.undo(now));
  ASSERT_TRUE(history.redo(now));
  ASSERT_TRUE(history.redo(now));
  EXPECT_EQ(now.pose.controls.at("breath"), 0.5);
  EXPECT_FALSE(history.redo(now));
}

TEST(PoseHistory, AChangeAfterAnUndoForgetsWhatWasUndone) {
  PoseHistory history;
  ViewSettings now = posing(1);
  history.note(now);
  now = posing(2);
  ASSERT_TRUE(history.undo(now)) << "although it was not noted";
  now = posing(3);
  EXPECT_FALSE(history.redo(now));
  EXPECT_EQ(now, posing(3));
  ASSERT_TRUE(history.undo(now));
  EXPECT_EQ(now, posing(1));
}

TEST(PoseHistory, LeavesTheRestOfThePosingAlone) {
  PoseHistory history;
  ViewSettings now = posing(1);
  history.note(now);
  now.pose.correction = 0.3;
  history.note(now);
  ASSERT_TRUE(history.undo(now));
  EXPECT_EQ(now.pose.joints.size(), 0u) << "the correction is no step";
  EXPECT_EQ(now.pose.correction, 0.3);
}

// What keys make of another frame is no step, and the last one comes back with its frame.
TEST(PoseHistory, KnowsTheFrameOfAStep) {
  PoseHistory history;
  ViewSettings now = posing(1);
  history.note(now, 100);
  history.follow(now = posing(7), 150);
  history.note(now, 150);
  EXPECT_EQ(history.undo(now, 150), 0) << "the beginning, not the pose of frame 150";
  EXPECT_EQ(history.redo(now, 0), 100);
  EXPECT_EQ(now, posing(1));
  history.follow(now = posing(7), 150);
  history.note(now = posing(8), 150);
  EXPECT_EQ(history.undo(now, 150), 150);
  EXPECT_EQ(now, posing(7));
  EXPECT_EQ(history.undo(now, 150), 100);
  EXPECT_EQ(now, posing(1));
}

TEST(PoseHistory, ForgetsTheOldest) {
  PoseHistory history;
  ViewSettings now;
  constexpr int kSteps = 3 * static_cast<int>(PoseHistory::kMostSteps);
  for (int k = 1; k <= kSteps; ++k) history.note(now = posing(k));
  std::size_t undone = 0;
  while (history.undo(now)) ++undone;
  EXPECT_EQ(undone, PoseHistory::kMostSteps);
  EXPECT_EQ(now, posing(kSteps - static_cast<int>(undone)));
}

// One after the other, without a picture between them.
TEST(PoseHistory, EveryCommandIsAStep) {
  Controls controls;
  controls.joint_names = {"LeftArm", "RightArm"};
  controls.joint_axes.assign(2, Quat{0, 0, 0, 1});
  const auto run = [&](const char* command) {
    run_command(controls, command);
    return controls.settings.pose.joints;
  };
  const auto turned = run("turn LeftArm 10 0 0");
  const auto mirrored = run("mirror LeftArm");
  EXPECT_EQ(mirrored.size(), 2u);
  EXPECT_TRUE(run("reset-pose").empty());
  EXPECT_EQ(run("undo"), mirrored);
  EXPECT_EQ(run("undo"), turned);
  controls.settings.pose.joints["LeftArm"] = {20, 0, 0};  // by a slider
  EXPECT_EQ(run("undo"), turned);
  EXPECT_TRUE(run("undo").empty());
  EXPECT_TRUE(controls.messages.empty());
  run("undo");
  EXPECT_EQ(controls.messages.size(), 1u);
}

}  // namespace
}  // namespace bodyopt::testing
