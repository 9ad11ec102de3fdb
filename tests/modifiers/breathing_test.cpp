// The breath over time.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "runtime/deformer/deformer.h"
#include "runtime/host/device_choice.h"
#include "tests/modifiers/driven_small_basis.h"
#include "tests/support/error_kind.h"

namespace bodyopt::testing {
namespace breathing_test {

constexpr double kRate = 24;

std::vector<Pose> driven(const Basis& basis, const std::vector<std::string>& channels, std::vector<Pose> poses) {
  drive_modifiers(basis, channels, kRate, poses);
  return poses;
}

Basis with_constants(const std::map<std::string, float>& constants) {
  Basis basis = breathing_basis();
  basis.modifiers.stack[0].constants = constants;
  return basis;
}

Evaluation on_cpu(const Basis& basis, std::span<const Pose> poses) {
  DeviceChoice cpu;
  cpu.name = "cpu";
  return Deformer(basis, cpu).evaluate(poses);
}

// Tops of the breath that are higher than the frames beside them.
int breaths(const std::vector<Pose>& poses) {
  int count = 0;
  for (std::size_t f = 1; f + 1 < poses.size(); ++f) {
    count += litres(poses[f - 1]) < litres(poses[f]) && litres(poses[f]) >= litres(poses[f + 1]);
  }
  return count;
}

TEST(Breathing, KeepsItsRateAndItsDepth) {
  const Basis basis = with_constants({{"rate", 15}, {"depth", 0.5f}, {"irregularity", 0}, {"chest", 0.6f}});
  const std::vector<Pose> poses = driven(basis, {}, bind_poses(basis, 60 * 24));
  EXPECT_EQ(breaths(poses), 15);
  double deepest = 0;
  for (const Pose& pose : poses) {
    EXPECT_GE(litres(pose), 0);
    deepest = std::max(deepest, litres(pose));
    EXPECT_NEAR(pose.modifiers[0], 0.6 * litres(pose), 1e-6);
  }
  EXPECT_NEAR(deepest, 0.5, 2e-3);
  EXPECT_EQ(litres(poses.front()), 0);
}

// A breath in is shorter than a breath out by the asymmetry, and the rest is the pause.
TEST(Breathing, IsAsymmetricAndPauses) {
  const Basis basis =
      with_constants({{"rate", 6}, {"irregularity", 0}, {"asymmetry", 3}, {"pause", 0.2f}});  // 240 frames a breath
  const std::vector<Pose> poses = driven(basis, {}, bind_poses(basis, 240));
  int in = 0, out = 0, still = 0;
  for (std::size_t f = 1; f < poses.size(); ++f) {
    const double change = litres(poses[f]) - litres(poses[f - 1]);
    ++(change > 0 ? in : change < 0 ? out : still);
  }
  EXPECT_NEAR(in, 48, 2);
  EXPECT_NEAR(out, 144, 2);
  EXPECT_NEAR(still, 48, 3);
}

TEST(Breathing, GoesOnSmoothlyWhereRatesChange) {
  const Basis basis = breathing_basis();
  std::vector<Pose> poses = bind_poses(basis, 480);
  std::vector<float> rates(480, 10), exertion(480, 0);
  std::fill(rates.begin() + 240, rates.end(), 30.0f);
  add_channel(poses, rates);
  add_channel(poses, exertion);
  const std::vector<Pose> breathed = driven(basis, {"shown.rate", "shown.exertion"}, poses);
  double largest = 0;
  for (std::size_t f = 1; f < breathed.size(); ++f) {
    largest = std::max(largest, std::abs(litres(breathed[f]) - litres(breathed[f - 1])));
  }
  // The steepest slope of a breath of 0.6 l and its irregularity that comes in within 0.6 s: pi / 2 of the mean.
  EXPECT_LT(largest, 1.08 * 0.6 * 1.5708 / (0.34 * 0.93 * 48));
}

TEST(Breathing, AHeldBreathStaysWhereItIs) {
  const Basis basis = breathing_basis();
  std::vector<Pose> poses = bind_poses(basis, 200);
  std::vector<float> hold(200, 0);
  std::fill(hold.begin() + 20, hold.begin() + 120, 1.0f);
  add_channel(poses, hold);
  const std::vector<Pose> breathed = driven(basis, {"shown.hold"}, poses);
  for (std::size_t f = 21; f < 120; ++f) EXPECT_EQ(breathed[f].modifiers, breathed[20].modifiers) << f;
  EXPECT_NE(breathed[125].modifiers, breathed[20].modifiers);
}

TEST(Breathing, IrregularBreathsDifferAndASeedRepeatsThem) {
  const Basis one = with_constants({{"irregularity", 1}, {"seed", 1}}),
              two = with_constants({{"irregularity", 1}, {"seed", 2}});
  const std::vector<Pose> a = driven(one, {}, bind_poses(one, 500)), b = driven(two, {}, bind_poses(two, 500)),
                          again = driven(one, {}, bind_poses(one, 500));
  std::size_t same_weights = 0;
  for (std::size_t f = 0; f < 500; ++f) {
    EXPECT_EQ(a[f].modifiers, again[f].modifiers);
    same_weights += a[f].modifiers == b[f].modifiers;
  }
  EXPECT_LT(same_weights, 150u);  // the pauses
}

// The whole clip is driven, and any of its frames evaluated.
TEST(Breathing, AChunkHasTheBitsOfTheWhole) {
  const Basis basis = breathing_basis();
  const std::vector<Pose> poses = driven(basis, {}, bind_poses(basis, 80));
  const Evaluation whole = on_cpu(basis, poses);
  const Evaluation chunk = on_cpu(basis, std::span(poses).subspan(50, 20));
  const std::size_t numbers = 3 * basis.mesh.output_count();
  EXPECT_EQ(std::vector(whole.positions.begin() + static_cast<std::ptrdiff_t>(50 * numbers),
                        whole.positions.begin() + static_cast<std::ptrdiff_t>(70 * numbers)),
            chunk.positions);
}

TEST(Breathing, WithoutStrengthNotABitChanges) {
  const Basis basis = breathing_basis();
  Basis without = basis;
  without.modifiers = {};
  std::vector<Pose> poses = bind_poses(basis, 50);
  poses[20].joints[1].rotation = axis_angle({0, 0, 1}, 0.7) * poses[20].joints[1].rotation;
  add_channel(poses, std::vector<float>(50, 0.0f));
  const std::vector<Pose> still = driven(basis, {"shown"}, poses);
  for (std::size_t f = 0; f < 50; ++f) {
    EXPECT_EQ(std::memcmp(still[f].joints.data(), poses[f].joints.data(), 2 * sizeof(JointTransform)), 0);
    poses[f].controls.clear();
  }
  std::vector<Pose> bare = still;
  for (Pose& pose : bare) {
    pose.controls.clear();
    pose.modifiers.clear();
  }
  std::vector<Pose> shown = still;
  for (Pose& pose : shown) pose.controls.clear();
  EXPECT_EQ(on_cpu(basis, shown).positions, on_cpu(without, bare).positions);
  // And switched off.
  Basis off = basis;
  off.modifiers.stack[0].on = false;
  EXPECT_EQ(on_cpu(off, driven(off, {}, poses)).positions, on_cpu(without, bare).positions);
}

TEST(Breathing, TurnsJointsWithTheChest) {
  const Basis basis = breathing_basis();
  const std::vector<Pose> poses = driven(basis, {}, bind_poses(basis, 30));
  const Quat expected =
      axis_angle({1, 0, 0}, 0.1 * static_cast<double>(poses[25].modifiers[0])) * basis.skeleton.joints[1].bind.rotation;
  ASSERT_GT(poses[25].modifiers[0], 0);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(poses[25].joints[1].rotation[i], expected[i], 1e-6);
}

// The joints turn far out of what was trained: what was learned, and what is said of it, are of the pose below.
TEST(Breathing, WhatWasLearnedGoesByThePoseWithoutIt) {
  Basis basis = breathing_basis();
  basis.modifiers.stack[0].turns = {{1, 0, 3, 0, 0}};
  Basis without = basis;
  without.modifiers = {};
  const std::vector<Pose> still = bind_poses(basis, 40), breathed = driven(basis, {}, still);
  const Evaluation expected = on_cpu(without, still), shown = on_cpu(basis, breathed);
  EXPECT_EQ(shown.strains, expected.strains);
  EXPECT_EQ(shown.fades, expected.fades);
  EXPECT_EQ(shown.outside, expected.outside);
  EXPECT_EQ(shown.fading_joint, expected.fading_joint);
  EXPECT_NE(shown.positions, expected.positions);
  std::vector<Pose> meant = breathed;  // so turned by the clip itself, they are another pose
  for (Pose& pose : meant) pose.unmodified.clear();
  EXPECT_GT(std::ranges::max(on_cpu(basis, meant).outside), std::ranges::max(expected.outside));
}

// A clip that was driven once is driven anew.
TEST(Breathing, APoseBelowIsThatOfThisClip) {
  const Basis basis = breathing_basis();
  std::vector<Pose> poses = driven(basis, {}, bind_poses(basis, 30));
  ASSERT_EQ(poses[25].unmodified.size(), 2u);
  EXPECT_EQ(poses[25].own_joints()[1].rotation, bind_pose(basis.skeleton).joints[1].rotation);
  EXPECT_TRUE(poses[0].unmodified.empty());  // nothing has moved
  Basis off = basis;
  off.modifiers.stack[0].on = false;
  poses = driven(off, {}, poses);
  EXPECT_EQ(poses[25].own_joints()[1].rotation, poses[25].joints[1].rotation);
}

TEST(DriveModifiers, ClampsAndSaysSo) {
  const Basis basis = breathing_basis();
  std::vector<Pose> poses = bind_poses(basis, 10);
  add_channel(poses, {0, 0, 0, 99, 0, 0, 0, 0, -1, 0});
  const std::vector<std::string> notes = drive_modifiers(basis, std::vector<std::string>{"shown.depth"}, kRate, poses);
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_NE(notes[0].find("'shown.depth'"), std::string::npos) << notes[0];
  EXPECT_NE(notes[0].find("2 of the clip's 10"), std::string::npos) << notes[0];
}

TEST(DriveModifiers, RefusesWhatItDoesNotKnow) {
  Basis basis = breathing_basis();
  std::vector<Pose> poses = bind_poses(basis, 2);
  basis.modifiers.stack[0].type = "levitation";
  EXPECT_EQ(kind_of([&] { drive_modifiers(basis, {}, kRate, poses); }), ErrorKind::mismatch);
  basis = with_modifier("breathing", 2, {});  // without the numbers that its type needs
  EXPECT_EQ(kind_of([&] { drive_modifiers(basis, {}, kRate, poses); }), ErrorKind::mismatch);
}

}  // namespace breathing_test
}  // namespace bodyopt::testing
