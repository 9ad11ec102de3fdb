// Shapes of like poses that disagree are found, and made to agree.
#include "trainer/curate/consistency.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <functional>
#include <random>

#include "dataset/modifier.h"
#include "runtime/core/error.h"
#include "tests/curate/sweep_history.h"
#include "trainer/curate/edit_stack.h"
#include "trainer/curate/local_models.h"

namespace bodyopt::trainer {
namespace {

double mean_rms_mm(const ShapeStack& stack, const CuratedLimb& limb) {
  double sum = 0;
  for (std::size_t n = 0; n < stack.database().frames.size(); ++n) {
    const DatabaseFrame& frame = stack.database().frames[n];
    sum += std::pow(rms_mm(stack.shape(n), limb.truth(frame.take, frame.frame)), 2);
  }
  return std::sqrt(sum / static_cast<double>(stack.database().frames.size()));
}

TEST(Consistency, RemovesInjectedDisagreement) {
  const Character character = limb_character();
  const CuratedLimb limb(
      [&](int take, int frame, const Positions& truth) { return with_history(character, take, frame, truth); });
  EXPECT_NEAR(mean_rms_mm(limb.stack(), limb), 3, 0.05);
  const ConsistencyReport before = report_consistency(limb.stack(), 12, 10);
  ASSERT_FALSE(before.pairs.empty());
  EXPECT_GT(before.pairs.front().apart_mm, 3);
  for (const DisagreeingPair& pair : before.pairs) {
    const PairInOnePose shapes = in_one_pose(limb.stack(), pair);
    const double seen = 1e3 * (shapes.second - shapes.first).rowwise().norm().maxCoeff();
    EXPECT_NEAR(pair.most_mm, seen, 0.05 * seen) << "what the picture shows is what the list says";
  }
  add_modifier(limb.path(), {.type = "consistency"});
  const double left = mean_rms_mm(limb.stack(), limb);
  EXPECT_LT(left, 0.05 * 3);
  std::printf("of 3 mm injected %.4f mm are left\n", left);
  EXPECT_LT(report_consistency(limb.stack(), 12, 10).pairs.front().apart_mm, before.pairs.front().apart_mm / 3);
}

TEST(Consistency, LeavesCleanDataAlone) {
  const CuratedLimb limb;
  add_modifier(limb.path(), {.type = "consistency"});
  const double moved = mean_rms_mm(limb.stack(), limb);
  EXPECT_LT(moved, 0.05);
  std::printf("clean shapes were moved by %.4f mm\n", moved);
}

// What skin touches pushes: nothing before, and then all at once, by 15 mm where the share is 1.
Positions pushed(const Character& character, double share, const Positions& truth) {
  const double depth = 0.015 * std::clamp(share, 0.0, 1.0);
  Positions result = truth;
  for (Eigen::Index v = 0; v < truth.rows(); ++v) {
    const double along = (character.vertices(v, 2) - 0.4) / 0.06, side = character.vertices(v, 1) / kLimbRadius;
    if (side < 0) result.row(v).x() += depth * side * side * std::exp(-along * along);
  }
  return result;
}

// How far the forearm of a frame is twisted, degrees. `twist`: of the takes, where the elbow is bent by a right angle.
double turned(const std::array<double, 2>& twist, int take, int frame) {
  return twist[static_cast<std::size_t>(take)] * std::sin(kDegree * sweep_angle(frame));
}

// Two motions pass by each other some degrees apart, and one touches where the other does not: that is a function of
// the pose, however sharply it bends, and no history.
TEST(Consistency, LeavesContactAlone) {
  const Character character = limb_character();
  const std::array<double, 2> twist = {-6, 6};
  const CuratedLimb limb(
      [&](int take, int frame, const Positions& truth) {
        return pushed(character, turned(twist, take, frame) / 2, truth);
      },
      twist);
  const ShapeStack raw = limb.stack();
  add_modifier(limb.path(), {.type = "consistency", .frames = {{{"frames", "5-19"}}}});
  const ShapeStack made = limb.stack();
  double worst = 0;
  for (std::size_t n = 0; n < raw.database().frames.size(); ++n) {
    worst = std::max(worst, rms_mm(raw.shape(n), made.shape(n)));
  }
  std::printf("shapes in contact were moved by %.4f mm RMS at most\n", worst);
  EXPECT_LT(worst, 0.3);
  for (const RegionAgreement& region : report_consistency(made, kAlikeDegrees, 10).regions) {
    EXPECT_GT(region.same_pose, 0) << region.region << ": to and fro are in the same poses";
  }
}

// The same with history on top: that goes, and contact, which one motion makes sooner than the other, stays.
TEST(Consistency, OfShapesInContactTakesTheHistoryAlone) {
  const Character character = limb_character();
  const std::array<double, 2> twist = {0, 8};
  const auto contact = [&](int take, int frame, const Positions& truth) {
    return pushed(character, (sweep_angle(frame) + 3 * turned(twist, take, frame) - 70) / 20, truth);
  };
  const auto history = [&](int take, int frame, const Positions& truth) {
    return with_history(character, take, frame, contact(take, frame, truth));
  };
  const CuratedLimb clean(contact, twist), limb(history, twist);
  add_modifier(limb.path(), {.type = "consistency"});
  const ShapeStack raw = clean.stack(), made = limb.stack();
  double sum = 0;
  const std::size_t count = raw.database().frames.size();
  for (std::size_t n = 0; n < count; ++n) sum += std::pow(rms_mm(raw.shape(n), made.shape(n)), 2);
  const double left = std::sqrt(sum / static_cast<double>(count));
  std::printf("of 3 mm injected into shapes in contact %.4f mm are left\n", left);
  EXPECT_LT(left, 0.2 * 3);
}

// Every pair that is listed disagrees somewhere; parts whose shapes vary with the pose alone have none.
TEST(Consistency, OfCleanDataListsNoPairThatAgrees) {
  const CuratedLimb limb;
  for (const DisagreeingPair& pair : report_consistency(limb.stack(), 12, 1000).pairs) {
    EXPECT_GT(pair.apart_mm, 0);
    EXPECT_LT(pair.apart_mm, 0.1);
    EXPECT_FALSE(pair.region.empty());
    EXPECT_GT(pair.most_mm, 0);
  }
}

// A belly beside a thigh, between which a joint stands still, and a shin.
PoseDatabase belly_and_leg() {
  PoseDatabase database;
  for (const auto& [name, parent] : {std::pair{"root", -1}, {"belly", 0}, {"hip", 0}, {"thigh", 2}, {"shin", 3}}) {
    Joint joint;
    joint.name = name;
    joint.parent = parent;
    database.character.skeleton.joints.push_back(joint);
  }
  database.character.vertices = Positions::Zero(5, 3);
  for (std::uint32_t j = 0; j < 5; ++j) database.character.weights.push_back({{j, 1.0f}});
  for (const double turn : {0.0, 0.3}) {
    DatabaseFrame& frame = database.frames.emplace_back();
    frame.pose.joints.resize(5);
    for (const std::size_t j : {0, 1, 3, 4}) frame.pose.joints[j].rotation = axis_angle({1, 0, 0}, turn);
  }
  return database;
}

TEST(Consistency, PartsAreComparedByTheNearestJointsThatTurn) {
  const std::vector<SkinPart> parts = skin_parts(belly_and_leg());
  ASSERT_EQ(parts.size(), 5u);
  EXPECT_EQ(parts[1].region.name, "belly");
  EXPECT_EQ(parts[1].joints, (std::vector<std::uint32_t>{1, 2, 3}));
  EXPECT_EQ(parts[3].joints, (std::vector<std::uint32_t>{1, 2, 3, 4}));
  EXPECT_EQ(parts[4].joints, (std::vector<std::uint32_t>{3, 4}));
  EXPECT_EQ(parts[1].others, (std::vector<std::uint32_t>{4}));
  EXPECT_EQ(parts[4].others, (std::vector<std::uint32_t>{1}));
}

// The thigh there and back, the shin otherwise on the way back.
PoseDatabase there_and_back() {
  PoseDatabase database = belly_and_leg();
  database.frames.clear();
  for (int k = 0; k < 40; ++k) {
    const double thigh = 0.02 * (k < 20 ? k : 39 - k),
                 shin = k < 20 ? 0.3 * std::sin(8 * thigh) : 0.3 * std::cos(5 * thigh);
    DatabaseFrame& frame = database.frames.emplace_back();
    frame.frame = k + 1;
    frame.pose.joints.resize(5);
    frame.pose.joints[3].rotation = axis_angle({1, 0, 0}, thigh);
    frame.pose.joints[4].rotation = axis_angle({1, 0, 0}, shin);
  }
  return database;
}

// What is found of the belly, RMS over the frames. `belly`: metres.
double found_of(const PoseDatabase& database,
                const std::function<double(int frame, double thigh, double shin)>& belly) {
  Displacements shapes = Displacements::Zero(40, 15);
  for (int k = 0; k < 40; ++k) {
    const std::vector<JointTransform>& joints = database.frames[static_cast<std::size_t>(k)].pose.joints;
    shapes(k, 3) =
        static_cast<float>(belly(k + 1, 2 * std::asin(joints[3].rotation[0]), 2 * std::asin(joints[4].rotation[0])));
  }
  const SkinPart belly_part = skin_parts(database)[1];
  const std::vector<char> all(40, 1), none(40, 0);
  const LocalModels models = local_models(database, belly_part, 20, all, none, shapes);
  return part_deviations(shapes, belly_part, models).norm() / std::sqrt(40.0);
}

// A belly that a joint from afar moves, too, agrees with itself; one that is another on the way back does not.
TEST(Consistency, WhatJointsFromAfarMoveIsNoHistory) {
  const PoseDatabase database = there_and_back();
  const auto moved = [](int, double thigh, double shin) { return 0.02 * thigh + 0.01 * shin + 0.02 * thigh * shin; };
  EXPECT_LT(found_of(database, moved), 5e-5);
  const auto history = [&](int frame, double thigh, double shin) {
    return moved(frame, thigh, shin) + (frame > 20 ? 0.001 : -0.001);
  };
  EXPECT_GT(found_of(database, history), 5e-4);
}

// What is found of the belly in the second of two frames, whose shapes are 2 mm apart; their joints by a part of 0.3.
double found_of_two(double turn) {
  PoseDatabase database = belly_and_leg();
  for (const std::size_t j : {0, 1, 3, 4}) {
    database.frames[1].pose.joints[j].rotation = axis_angle({1, 0, 0}, turn * 0.3);
  }
  database.frames[1].take = 1;
  Displacements shapes = Displacements::Zero(2, 15);
  shapes(1, 3) = 0.002f;
  const SkinPart belly = skin_parts(belly_and_leg())[1];
  const std::vector<char> all(2, 1), none(2, 0);
  const LocalModels models = local_models(database, belly, 30, all, none, shapes);
  EXPECT_EQ(models.others[0].size(), 1u) << "they are compared";
  return part_deviations(shapes, belly, models)(1, 0);
}

// Two frames alone do not tell what varies with the pose: in the same pose they disagree, in like poses they may.
TEST(Consistency, OfTwoFramesThePosesTell) {
  EXPECT_NEAR(found_of_two(0), 0.001, 1e-4);
  EXPECT_LT(std::abs(found_of_two(1)), 2e-5);
}

// Five frames of two motions in like poses, hardly further apart than each motion's own: asked five times of each other
// they are five frames still, and so few prove nothing of variances. What is taken for history is the same, whatever
// chance adds.
TEST(Consistency, FramesThatPassByEachOtherCountOnce) {
  PoseDatabase database = belly_and_leg();
  database.frames.resize(5, database.frames[0]);
  for (int k = 0; k < 5; ++k) {
    DatabaseFrame& frame = database.frames[static_cast<std::size_t>(k)];
    frame.take = k < 3 ? 0 : 1;
    frame.frame = k + 1;
    frame.pose.joints[3].rotation = axis_angle({1, 0, 0}, 0.03 * (k % 3));
  }
  const SkinPart belly{{"belly", {1}, {1.0}}, {3}, {}};
  const std::vector<char> all(5, 1), none(5, 0);
  std::mt19937 random(1);
  std::normal_distribution<float> normal;
  std::vector<double> expected;
  for (int chance = 0; chance < 20; ++chance) {
    Displacements shapes = Displacements::Zero(5, 15);
    for (int k = 0; k < 5; ++k) {
      for (int i = 3; i < 6; ++i) shapes(k, i) = (k < 3 ? 0.0005f : -0.0005f) + 0.0003f * normal(random);
    }
    std::vector<double> shares;
    for (const std::vector<FrameShare>& of_frame : local_models(database, belly, 20, all, none, shapes).shares) {
      for (const FrameShare& other : of_frame) shares.push_back(other.share);
    }
    if (chance == 0) expected = shares;
    EXPECT_EQ(shares, expected) << chance;
  }
}

// A pose is held for longer than frames of a pass are kept: others in it stand before, and the frame is kept even so.
TEST(Consistency, AFrameIsAmongItsOwnNeighbours) {
  constexpr std::size_t kHeld = 12, kPassing = 2;
  PoseDatabase database = belly_and_leg();
  database.frames.assign(kHeld + kPassing, DatabaseFrame(database.frames[0]));
  Displacements shapes = Displacements::Zero(kHeld + kPassing, 15);
  for (std::size_t n = 0; n < database.frames.size(); ++n) {
    database.frames[n].take = n < kHeld ? 0 : 1;
    database.frames[n].frame = static_cast<int>(n) + 1;
    shapes(static_cast<Eigen::Index>(n), 3) = n < kHeld ? 0 : 0.001f;
  }
  const std::vector<char> all(database.frames.size(), 1), none(database.frames.size(), 0);
  const LocalModels models = local_models(database, {{"belly", {1}, {1.0}}, {3}, {}}, 20, all, none, shapes);
  for (std::size_t n = 0; n < database.frames.size(); ++n) {
    EXPECT_EQ(std::ranges::count(models.shares[n], n, &FrameShare::frame), 1) << n;
  }
}

// What shapes disagree in, by the models of the raw ones.
class Disagreement {
 public:
  Disagreement(const ShapeStack& raw, double degrees) : parts_(skin_parts(raw.database())) {
    const std::size_t frames = raw.database().frames.size();
    const std::vector<char> all(frames, 1), none(frames, 0);
    const Displacements shapes = shapes_of(raw, 0);
    for (const SkinPart& part : parts_) {
      models_.push_back(local_models(raw.database(), part, degrees, all, none, shapes));
    }
  }
  // RMS of all vertices, mm.
  double left_of(const ShapeStack& stack) const {
    const Displacements made = shapes_of(stack, stack.database().dataset.modifiers.size());
    Displacements sum = Displacements::Zero(made.rows(), made.cols());
    for (std::size_t p = 0; p < parts_.size(); ++p) {
      const RegionWeights& region = parts_[p].region;
      const Displacements own = part_deviations(made, parts_[p], models_[p]);
      for (std::size_t k = 0; k < region.vertices.size(); ++k) {
        sum.middleCols<3>(3 * Eigen::Index{region.vertices[k]}) +=
            static_cast<float>(region.weights[k]) * own.middleCols<3>(3 * static_cast<Eigen::Index>(k));
      }
    }
    return 1e3 * double{sum.norm()} / std::sqrt(static_cast<double>(sum.size() / 3));
  }

 private:
  static Displacements shapes_of(const ShapeStack& stack, std::size_t count) {
    return all_displacements(stack.database(), "the test", [&](std::size_t n) { return stack.offsets(n, count); });
  }

  std::vector<SkinPart> parts_;
  std::vector<LocalModels> models_;
};

// Shapes that are noise have no slope: what is taken from one frame comes back in others, and after some ten steps the
// next would leave more.
TEST(Consistency, AStepThatLeavesMoreIsNotTaken) {
  const CuratedLimb limb([&](int take, int frame, const Positions& truth) {
    std::mt19937 random(static_cast<unsigned>(100 * take + frame));
    Positions shape = truth;
    shape.col(0).array() += std::uniform_real_distribution<>(-0.004, 0.004)(random);
    return shape;
  });
  constexpr double kDegrees = 13;
  const Disagreement disagreement(limb.stack(), kDegrees);
  double left = disagreement.left_of(limb.stack());
  std::printf("%.5f", left);
  add_modifier(limb.path(), {.type = "consistency", .parameters = {{"degrees", kDegrees}}});
  for (const int iterations : {1, 10, 20}) {
    change_modifier(limb.path(), "consistency", {.parameters = {{"iterations", iterations}}});
    const double now = disagreement.left_of(limb.stack());
    std::printf(" %.5f", now);
    EXPECT_LE(now, left * (1 + 1e-5)) << iterations;
    left = now;
  }
  std::printf("\n");
}

// What it does not move it does not take to un-posed space and back: rounding there is no change either.
TEST(Consistency, AFrameThatNothingIsFoundInIsTheRawOneBitForBit) {
  const CuratedLimb limb;
  add_modifier(limb.path(), {.type = "consistency", .frames = {{{"take", "one"}, {"frames", "1-21"}}}});
  const ShapeStack stack = limb.stack();
  for (std::size_t n = 0; n < stack.database().frames.size(); ++n) {
    ASSERT_EQ(stack.shape(n), stack.database().raw_shape(n)) << n;
  }
}

TEST(Consistency, ItsCacheGivesTheSameShapes) {
  const Character character = limb_character();
  const CuratedLimb limb(
      [&](int take, int frame, const Positions& truth) { return with_history(character, take, frame, truth); });
  add_modifier(limb.path(), {.type = "consistency", .parameters = {{"iterations", 1}}});
  const Positions first = limb.stack().shape(10), second = limb.stack().shape(10);
  EXPECT_EQ(first, second);
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(limb.folder() / "modifiers" / "cache")) {
    files += entry.is_regular_file() ? 1 : 0;
  }
  EXPECT_EQ(files, 1u);
}

TEST(Consistency, ADamagedCacheIsWorkedOutAgain) {
  const Character character = limb_character();
  const CuratedLimb limb(
      [&](int take, int frame, const Positions& truth) { return with_history(character, take, frame, truth); });
  add_modifier(limb.path(), {.type = "consistency", .parameters = {{"iterations", 1}}});
  const Positions first = limb.stack().shape(10);
  for (const auto& entry : std::filesystem::directory_iterator(limb.folder() / "modifiers" / "cache")) {
    std::fstream file(entry.path(), std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(static_cast<std::streamoff>(entry.file_size() / 8));  // in what is added to frame 10
    for (int k = 0; k < 400; ++k) file.write("\x3f\x3f\x3f\x3f", 4);
  }
  EXPECT_EQ(limb.stack().shape(10), first);
}

TEST(Consistency, FrozenFramesStayAndDrawTheOthers) {
  const Character character = limb_character();
  const CuratedLimb limb([&](int take, int, const Positions& truth) {
    Positions shape = truth;
    if (take == 1) shape.col(0).array() += 0.004;
    return shape;
  });
  add_modifier(limb.path(), {.type = "freeze", .frames = {{{"take", "one"}}}});
  add_modifier(limb.path(), {.type = "consistency", .parameters = {{"iterations", 6}}});
  const ShapeStack stack = limb.stack();
  EXPECT_LT(rms_mm(stack.shape(10), limb.truth(0, 11)), 1e-3);
  EXPECT_LT(rms_mm(stack.shape(kSweepFrames + 10), limb.truth(1, 11)), 1.0);
}

TEST(Consistency, WithoutFramesThereIsNothingToReport) {
  const CuratedLimb limb;
  Dataset dataset = read_dataset(limb.path());
  dataset.takes.clear();
  write_dataset(dataset, limb.path());
  try {
    report_consistency(limb.stack(), 12, 10);
    FAIL() << "reported on no frames";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::mismatch);
    EXPECT_NE(std::string(error.what()).find("names no takes"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace bodyopt::trainer
