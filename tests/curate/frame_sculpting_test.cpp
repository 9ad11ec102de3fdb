// What is brushed on a frame, and what the dataset makes of it.
#include "trainer/curate/frame_sculpting.h"

#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>

#include "dataset/modifier.h"
#include "runtime/core/atomic_file.h"
#include "tests/curate/curated_limb.h"
#include "tests/support/error_kind.h"
#include "trainer/curate/edit_stack.h"
#include "trainer/curate/named_shapes.h"

namespace bodyopt::testing {
namespace {

using namespace trainer;

using namespace std::chrono_literals;

constexpr std::size_t kBent = 15;  // frame 16 of take "one", the elbow bent by 90 degrees
constexpr Brush kGrab{BrushKind::grab, 0.06, 1};

std::shared_ptr<const ShapeStack> shared_stack(const CuratedLimb& limb) {
  return std::make_shared<const ShapeStack>(read_pose_database(read_dataset(limb.path())));
}

FrameSculpting sculpting(const CuratedLimb& limb, std::size_t frame = kBent,
                         std::optional<double> spread = std::nullopt) {
  return FrameSculpting(shared_stack(limb), frame, "brush", spread);
}

// At a vertex, as it is seen.
SkinPoint at_vertex(const FrameSculpting& frame, std::uint32_t vertex) {
  const Triangles& triangles = frame.stack().database().character.triangles;
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) {
      if (triangles(t, k) != vertex) continue;
      SkinPoint point{t, {triangles(t, 0), triangles(t, 1), triangles(t, 2)}, Eigen::Vector3d::Unit(k), {}};
      point.position = frame.skin().row(vertex).transpose();
      return point;
    }
  }
  return {};
}

constexpr std::uint32_t vertex(int ring, int side) { return static_cast<std::uint32_t>(ring * kLimbSides + side); }

void pull(FrameSculpting& frame, std::uint32_t at, const Eigen::Vector3d& way, bool mirrored = false) {
  frame.begin(kGrab, mirrored);
  frame.touch(at_vertex(frame, at));
  frame.pull(way);
}

TEST(FrameSculpting, APointIsPulledAsItIsSeenAndKeptSo) {
  const CuratedLimb limb;
  FrameSculpting frame = sculpting(limb);
  const Positions before = frame.skin();
  EXPECT_LT(rms_mm(before, limb.truth(0, 16)), 1e-4);
  EXPECT_FALSE(frame.has_change());
  const std::uint32_t elbow = vertex(17, 4);
  pull(frame, elbow, {0, 0.01, 0.004});
  const Eigen::RowVector3d moved = frame.skin().row(elbow) - before.row(elbow);
  EXPECT_LT((moved - Eigen::RowVector3d(0, 0.01, 0.004)).norm(), 1e-6);
  EXPECT_TRUE(limb.stack().database().dataset.modifiers.empty()) << "nothing is written yet";
  EXPECT_EQ(frame.keep(1s), std::vector<std::string>());
  const ShapeStack stack = limb.stack();
  ASSERT_EQ(stack.database().dataset.modifiers.size(), 1u);
  EXPECT_EQ(stack.database().dataset.modifiers[0].name, "brush");
  EXPECT_LT(rms_mm(stack.shape(kBent), frame.skin()), 1e-4);
  EXPECT_EQ(stack.shape(0), stack.database().raw_shape(0)) << "90 degrees away";
  undo_modifiers(limb.path());
  EXPECT_EQ(limb.stack().shape(kBent), limb.stack().database().raw_shape(kBent));
}

// Half at half the spread, as the map of poses shows it, and as the frames are then.
TEST(FrameSculpting, TheWeightsThatAreShownAreThoseThatAct) {
  const CuratedLimb limb;
  FrameSculpting frame = sculpting(limb, kBent, 24);
  const std::uint32_t elbow = vertex(17, 4);
  pull(frame, elbow, {0, 0.01, 0});
  const std::vector<double> weights = frame.weights();
  const Positions strokes = frame.skin() - limb.truth(0, 16);
  EXPECT_DOUBLE_EQ(weights[kBent], 1);
  EXPECT_NEAR(weights[kBent - 2], 0.5, 0.01) << "12 degrees";
  EXPECT_LT(weights[kBent - 4], 1e-9) << "24 degrees";
  frame.keep(1s);
  const ShapeStack stack = limb.stack();
  for (const std::size_t n : {kBent - 2, kBent - 1, kBent + 1, kBent + 2, kBent + 4}) {
    const Positions own = stack.offsets(n, 1) - stack.offsets(n, 0);
    EXPECT_NEAR(own.row(elbow).norm(), weights[n] * strokes.row(elbow).norm(), 1e-6) << n;
  }
}

TEST(FrameSculpting, StrokesOfTheSameAndOfOtherFramesAddUpAsSeen) {
  const CuratedLimb limb;
  FrameSculpting first = sculpting(limb);
  pull(first, vertex(17, 4), {0, 0.01, 0});
  first.keep(1s);
  FrameSculpting second = sculpting(limb);
  EXPECT_LT(rms_mm(second.skin(), first.skin()), 1e-4);
  pull(second, vertex(20, 8), {-0.008, 0, 0});
  second.keep(1s);
  EXPECT_LT(rms_mm(limb.stack().shape(kBent), second.skin()), 1e-4);
  FrameSculpting near = sculpting(limb, kBent + 1);  // which the first frame's sculpt reaches
  const Positions shown = near.skin();
  EXPECT_GT(rms_mm(shown, limb.truth(0, 17)), 0.1);
  pull(near, vertex(12, 0), {0.005, 0, 0});
  near.keep(1s);
  EXPECT_LT(rms_mm(limb.stack().shape(kBent + 1), near.skin()), 1e-4);
  EXPECT_LT(rms_mm(limb.stack().shape(kBent), second.skin()), 1e-4) << "exact at its own pose";
  EXPECT_EQ(limb.stack().database().dataset.modifiers.size(), 1u);
}

TEST(FrameSculpting, EraseTakesAwayWhatTheModifierAdds) {
  const CuratedLimb limb;
  add_modifier(limb.path(), {.type = "inflate"});
  const Positions below = limb.stack().shape(kBent);
  FrameSculpting frame = sculpting(limb);
  pull(frame, vertex(17, 4), {0, 0.01, 0});
  frame.keep(1s);
  FrameSculpting again = sculpting(limb);
  ASSERT_GT(rms_mm(again.skin(), below), 0.1);
  again.begin({BrushKind::erase, 0.5, 1}, false);
  for (int k = 0; k < 60; ++k) again.touch(at_vertex(again, vertex(17, 4)));
  EXPECT_LT(rms_mm(again.skin(), below), 1e-4);
}

// Bent sideways, so that the posed limb is not symmetric, but un-posed it is.
TEST(FrameSculpting, TheOtherSideDoesTheSameUnposed) {
  const CuratedLimb limb;
  FrameSculpting frame = sculpting(limb, 41 + kBent);
  const Positions before = frame.skin();
  pull(frame, vertex(20, 1), {0.01, 0.002, 0}, true);
  frame.keep(1s);
  const ShapeStack stack = limb.stack();
  const Positions moved = stack.offsets(41 + kBent, 1) - stack.offsets(41 + kBent, 0);
  EXPECT_GT(moved.row(vertex(20, 1)).norm(), 0.009);
  for (int side = 0; side < kLimbSides; ++side) {
    const Eigen::RowVector3d own = moved.row(vertex(20, side)), other = moved.row(vertex(20, (24 - side) % kLimbSides));
    EXPECT_LT((own - Eigen::RowVector3d(-other.x(), other.y(), other.z())).norm(), 1e-3) << side;
  }
}

TEST(FrameSculpting, WhatOthersEditMeanwhileStays) {
  const CuratedLimb limb;
  FrameSculpting frame = sculpting(limb);
  pull(frame, vertex(17, 4), {0, 0.01, 0});
  add_modifier(limb.path(), {.type = "inflate", .strength = 0.5});
  const Positions below = limb.stack().offsets(kBent, 1);
  frame.keep(1s);
  const ShapeStack stack = limb.stack();
  ASSERT_EQ(stack.database().dataset.modifiers.size(), 2u);
  const Positions added = stack.offsets(kBent, 2) - below;
  EXPECT_NEAR(added.row(vertex(17, 4)).norm(), 0.01, 1e-6);
}

TEST(FrameSculpting, WhileAnotherEditsItSaysSoAndKeepsTheStrokes) {
  const CuratedLimb limb;
  FrameSculpting frame = sculpting(limb);
  pull(frame, vertex(17, 4), {0, 0.01, 0});
  {
    const FileLock lock = lock_to_change(limb.path());
    EXPECT_EQ(kind_of([&] { frame.keep(20ms); }), ErrorKind::file);
  }
  EXPECT_TRUE(limb.stack().database().dataset.modifiers.empty());
  EXPECT_TRUE(frame.has_change());
  frame.keep(1s);
  EXPECT_LT(rms_mm(limb.stack().shape(kBent), frame.skin()), 1e-4);
}

TEST(FrameSculpting, ModifiersThatWouldHideAStrokeAreRefused) {
  const CuratedLimb limb;
  const auto refused = [&](const ModifierChange& change) {
    change_modifier(limb.path(), "brush", change);
    const bool refuses = kind_of([&] { sculpting(limb); }) == ErrorKind::usage;
    undo_modifiers(limb.path());
    return refuses;
  };
  FrameSculpting frame = sculpting(limb);
  pull(frame, vertex(17, 4), {0, 0.01, 0});
  frame.keep(1s);
  EXPECT_TRUE(refused({.strength = 0.5}));
  EXPECT_TRUE(refused({.frames = Json::array({{{"take", "two"}}})}));
  EXPECT_TRUE(refused({.mask = Json{{"joints", {"joint1"}}}}));
  enable_modifier(limb.path(), "brush", false);
  EXPECT_EQ(kind_of([&] { sculpting(limb); }), ErrorKind::usage);
  remove_modifier(limb.path(), "brush");
  add_modifier(limb.path(), {.name = "brush", .type = "smooth"});
  EXPECT_EQ(kind_of([&] { sculpting(limb); }), ErrorKind::usage);
}

TEST(FrameSculpting, AFrozenFrameIsSaidAndBrushed) {
  const CuratedLimb limb;
  add_modifier(limb.path(), {.type = "freeze", .frames = Json::array({{{"take", "one"}, {"frames", "16"}}})});
  FrameSculpting frame = sculpting(limb);
  pull(frame, vertex(17, 4), {0, 0.01, 0});
  const std::vector<std::string> notes = frame.keep(1s);
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_NE(notes[0].find("one 16 is frozen"), std::string::npos) << notes[0];
  EXPECT_LT(rms_mm(limb.stack().shape(kBent), frame.skin()), 1e-4);
}

TEST(FrameSculpting, WhatIsNotFiniteIsNotKept) {
  const CuratedLimb limb;
  FrameSculpting frame = sculpting(limb);
  pull(frame, vertex(17, 4), {0, NAN, 0});
  EXPECT_EQ(kind_of([&] { frame.keep(1s); }), ErrorKind::mismatch);
  EXPECT_TRUE(limb.stack().database().dataset.modifiers.empty());
}

// A dataset that is read again after an edit has what was made of its character.
TEST(FrameSculpting, UnposedSpaceOutlivesAnEdit) {
  const CuratedLimb limb;
  const NamedShapes shapes(limb.path().string());
  shapes.stack()->space();
  add_modifier(limb.path(), {.type = "inflate"});
  const NamedShapes now = shapes.as_they_are();
  EXPECT_NE(now.stack(), shapes.stack());
  EXPECT_EQ(now.stack()->made_space(), shapes.stack()->made_space());
}

}  // namespace
}  // namespace bodyopt::testing
