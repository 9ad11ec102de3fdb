// The clip of a character's range of motion: on the built-in arm, with limits of its own.
#include "trainer/motion/range_of_motion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <numeric>
#include <set>

#include "base/progress.h"
#include "runtime/core/error.h"
#include "tests/builtin/shared_arm.h"
#include "tests/support/capsule_limb.h"
#include "trainer/motion/explore.h"
#include "trainer/motion/held_turns.h"

namespace bodyopt::trainer {
namespace {

std::uint32_t joint(const char* name) { return static_cast<std::uint32_t>(arm().character.skeleton.find(name)); }

const Skeleton& skeleton() { return arm().character.skeleton; }

// A ball joint, a hinge, and a curl that several joints share.
const JointLimits& limits() {
  static const JointLimits made{
      {{"plane", 0, -20, 60, {{joint("shoulder"), {0, 1, 0}}}},
       {"raise", 50, 30, 115, {{joint("shoulder"), {0, 0, -1}}, {joint("clavicle"), {0, 0, -1}, 0.2}}},
       {"spin", 0, -50, 50, {{joint("shoulder"), {-0.766, -0.643, 0}}}},
       {"elbow", 20, 0, 120, {{joint("elbow"), {-0.643, 0.766, 0}}}},
       {"curl", 10, 0, 70, {{joint("fingers"), {0, 0, 1}}, {joint("fingertips"), {0, 0, 1}, 1.1}}}},
      {{joint("fingers"), 25}}};
  return made;
}

const RangeOfMotion& motion() {
  static const RangeOfMotion made = range_of_motion(arm().character, limits(), {1200, 7, {}});
  return made;
}

TEST(RangeOfMotion, StartsAtRestAndStaysWithinLimits) {
  ASSERT_EQ(motion().postures.size(), 1200u);
  EXPECT_EQ(1 + motion().sweep_frames + motion().pair_frames + motion().touching_frames + motion().random_frames,
            1200u);
  EXPECT_LE(motion().sweep_frames, 240u);
  EXPECT_LE(motion().pair_frames, 120u);
  EXPECT_EQ(motion().postures[0], Posture{rest_angles(limits())});
  for (const Posture& posture : motion().postures) {
    for (std::size_t k = 0; k < posture.angles.size(); ++k) {
      ASSERT_GE(posture.angles[k], limits().dofs[k].min - 1e-9);
      ASSERT_LE(posture.angles[k], limits().dofs[k].max + 1e-9);
    }
    for (std::size_t j = 0; j < posture.deviations.size(); ++j) {
      ASSERT_LE(length(posture.deviations[j]), j == joint("fingers") ? 25 : 0) << skeleton().joints[j].name;
    }
  }
}

TEST(RangeOfMotion, CanBeInterrupted) {
  const auto interrupted = [] {
    arm();  // which is made with progress, too
    catch_interrupts();
    std::raise(SIGINT);
    try {
      range_of_motion(arm().character, limits(), {1200, 7, {}});
    } catch (const Error& error) {
      std::fputs(error.what(), stderr);
      std::exit(error.exit_code());
    }
    std::exit(0);
  };
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(interrupted(), ::testing::ExitedWithCode(75), "rom: interrupted");
}

TEST(RangeOfMotion, SweepsReachEachLimitAlone) {
  for (std::size_t k = 0; k < limits().dofs.size(); ++k) {
    for (const double limit : {limits().dofs[k].min, limits().dofs[k].max}) {
      Angles wanted = rest_angles(limits());
      wanted[k] = limit;
      const auto begin = motion().postures.begin() + 1, end = begin + static_cast<long>(motion().sweep_frames);
      EXPECT_TRUE(std::any_of(begin, end, [&](const Posture& p) { return largest_change(p, {wanted}) < 1e-9; }))
          << limits().dofs[k].name << " " << limit;
    }
  }
}

TEST(RangeOfMotion, NeighboursAreAsCloseAsAskedFor) {
  const RangeOfMotion smooth = range_of_motion(arm().character, limits(), {1200, 7, {}, 25});
  const std::vector<Posture>& postures = smooth.postures;
  double largest = 0;
  for (std::size_t k = 1 + smooth.sweep_frames + smooth.pair_frames; k < postures.size(); ++k) {
    largest = std::max(largest, largest_change(postures[k - 1], postures[k]));
  }
  EXPECT_NEAR(largest, 25, 1e-6);
  const std::vector<Posture>& free = motion().postures;
  EXPECT_GT(largest_change(free[free.size() - 2], free.back()), 25);
}

// As deep as half a limb's radius, and of more than one pair of limbs.
TEST(RangeOfMotion, HasPosesInWhichLimbsTouch) {
  const JointLimits with_thumb = arm_limits(skeleton());
  const RangeOfMotion made = range_of_motion(arm().character, with_thumb, {400, 7, {}});
  EXPECT_EQ(made.touching_frames, 100u);
  const SelfOverlap overlap = overlap_of_limits(arm().character, with_thumb);
  std::set<std::pair<std::uint32_t, std::uint32_t>> touched;
  std::vector<double> depths;
  const std::size_t first = made.postures.size() - made.random_frames - made.touching_frames;
  for (std::size_t k = 0; k < made.touching_frames; ++k) {
    const SelfOverlap::Touch touch = overlap.deepest(limited_pose(skeleton(), with_thumb, made.postures[first + k]));
    ASSERT_LE(touch.depth, 0.5);
    ASSERT_GT(touch.depth, -0.05);
    depths.push_back(touch.depth);
    touched.insert(touch.joints);
  }
  std::ranges::sort(depths);
  EXPECT_NEAR(depths[depths.size() / 2], 0.25, 0.1);
  EXPECT_GE(touched.size(), 2u);
}

// Fingers and fingertips curl in fixed shares; what deviates tells them apart, in random frames only.
TEST(RangeOfMotion, JointsDeviateFromWhatCouplesThem) {
  const std::size_t first_random = motion().postures.size() - motion().random_frames;
  double sum = 0;
  for (std::size_t k = 0; k < motion().postures.size(); ++k) {
    const Posture& posture = motion().postures[k];
    const double turned = posture.deviations.empty() ? 0 : length(posture.deviations[joint("fingers")]);
    if (k < first_random) {
      ASSERT_EQ(turned, 0);
    }
    sum += turned;
  }
  // Four of five draws, anywhere in a ball of 25 degrees.
  EXPECT_GT(sum / static_cast<double>(motion().random_frames), 0.9 * 0.8 * 0.75 * 25);
}

// Between two poses an elbow bends as they do; anywhere within the limits it rarely would.
TEST(RangeOfMotion, ManyPosesLieBetweenCommonOnes) {
  JointLimits common = limits();
  common.poses = {{"straight", rest_angles(limits())}, {"bent", rest_angles(limits())}};
  common.poses[0].angles[3] = 10;
  common.poses[1].angles[3] = 20;
  const RangeOfMotion made = range_of_motion(arm().character, common, {600, 7, {}});
  const auto near = [&](const RangeOfMotion& motion) {
    const auto begin = motion.postures.end() - static_cast<long>(motion.random_frames);
    const auto count = std::count_if(begin, motion.postures.end(), [](const Posture& posture) {
      return posture.angles[3] > 2 && posture.angles[3] < 28;
    });
    return static_cast<double>(count) / static_cast<double>(motion.random_frames);
  };
  EXPECT_GT(near(made), 1.2 * near(motion()));
}

TEST(RangeOfMotion, DependsOnItsSeedOnly) {
  const RangeOfMotion again = range_of_motion(arm().character, limits(), {1200, 7, {}});
  EXPECT_EQ(again.postures, motion().postures);
  const RangeOfMotion other = range_of_motion(arm().character, limits(), {1200, 8, {}});
  EXPECT_GT(largest_change(other.postures.back(), motion().postures.back()), 1);
}

TEST(RangeOfMotion, TakesAnyLength) {
  for (const int count : {1, 2, 7, 20, 48}) {
    EXPECT_EQ(range_of_motion(arm().character, limits(), {count, 3, {}}).postures.size(),
              static_cast<std::size_t>(count));
  }
  EXPECT_THROW(range_of_motion(arm().character, limits(), {0, 3, {}}), Error);
}

// Against as many poses drawn uniformly as the clip has random frames: that neighbours are close must cost little.
TEST(RangeOfMotion, CoversNearlyAsMuchAsPosesThatAreNotConnected) {
  UniformRandom random(99);
  RangeOfMotion plain;
  while (plain.postures.size() < motion().random_frames) plain.postures.push_back({random_angles(limits(), random)});
  const SelfOverlap overlap = overlap_of_limits(arm().character, limits());
  const std::vector<Pose> wanted = random_poses(limits(), skeleton(), overlap, 1000, 5);
  const auto ours = coverage(clip_of(motion(), limits(), skeleton()).poses, wanted, arm().character);
  const auto theirs = coverage(clip_of(plain, limits(), skeleton()).poses, wanted, arm().character);
  ASSERT_EQ(ours.size(), theirs.size());
  for (std::size_t j = 0; j < ours.size(); ++j) {
    SCOPED_TRACE(ours[j].joint);
    RecordProperty(ours[j].joint + "_mean_and_largest",
                   std::to_string(ours[j].mean) + " " + std::to_string(ours[j].largest) + ", of plain random poses " +
                       std::to_string(theirs[j].mean) + " " + std::to_string(theirs[j].largest));
    if (ours[j].joint != "shoulder") continue;  // hinges are covered to a fraction of a degree by either
    EXPECT_LT(ours[j].largest, 1.3 * theirs[j].largest);
    EXPECT_LT(ours[j].mean, 1.2 * theirs[j].mean);
  }
}

// A joint that all of the skin hangs under is as the root: training learns nothing of how it turns.
TEST(JointCoverage, LeavesOutWhatMovesAllOfTheSkin) {
  Character limb = limb_character();
  for (std::size_t v = 0; v < limb.weights.size(); ++v) limb.weights[v] = {{v % 2 == 0 ? 1u : 2u, 1.0}};
  const std::vector<Pose> wanted = {limb_pose(limb.skeleton, 1, 0, 1)};
  const std::vector<JointCoverage> covered = coverage({bind_pose(limb.skeleton)}, wanted, limb);
  ASSERT_EQ(covered.size(), 1u);
  EXPECT_EQ(covered.front().joint, "joint2");
}

TEST(RangeOfMotion, RandomPosesOverlapNoMoreThanTheSweeps) {
  const SelfOverlap overlap = overlap_of_limits(arm().character, limits());
  const std::size_t swept = 1 + motion().sweep_frames, touching = swept + motion().pair_frames;
  for (std::size_t k = swept; k < motion().postures.size(); ++k) {
    if (k >= touching && k < touching + motion().touching_frames) continue;  // which are made to overlap
    ASSERT_FALSE(overlap.find(limited_pose(skeleton(), limits(), motion().postures[k]))) << "frame " << k + 1;
  }
}

// An arm that turns about one axis, far beyond what the limits allow: random poses must do the same and nothing else.
TEST(RangeOfMotion, StaysWithTheExamplesBeyondTheLimits) {
  const Quat bind = skeleton().joints[joint("elbow")].bind.rotation;
  std::vector<Pose> examples;
  for (int k = 0; k <= 20; ++k) {
    Pose& pose = examples.emplace_back(bind_pose(skeleton()));
    pose.joints[joint("elbow")].rotation = bind * axis_angle({1, 0, 0}, 0.1 * k);
    pose.joints[0].rotation = axis_angle({0, 1, 0}, 0.3 * k);  // the root's: left out
    pose.joints[0].translation = {1.0 * k, 0, 0};
  }
  JointLimits coupled = limits();
  coupled.deviations.clear();
  const RangeOfMotion made = range_of_motion(arm().character, coupled, {400, 3, examples});
  const Clip clip = clip_of(made, limits(), skeleton());
  ASSERT_EQ(clip.poses.size(), 400u);
  ASSERT_EQ(made.blends.size(), made.random_frames);
  double lowest = 180, highest = 0;
  for (std::size_t k = 400 - made.random_frames / 2; k < 400; ++k) {
    for (std::uint32_t j = 0; j < skeleton().size(); ++j) {
      if (j == joint("elbow")) continue;
      const Quat turn = conjugate(skeleton().joints[j].bind.rotation) * clip.poses[k].joints[j].rotation;
      ASSERT_LT(angle_of(turn), 1e-4) << "frame " << k + 1;
    }
    const Quat own = conjugate(bind) * clip.poses[k].joints[joint("elbow")].rotation;
    ASSERT_NEAR(std::abs(own[1]) + std::abs(own[2]), 0, 1e-7) << "another axis, frame " << k + 1;
    lowest = std::min(lowest, angle_of(own));
    highest = std::max(highest, angle_of(own));
  }
  EXPECT_LT(lowest, 12);
  EXPECT_GT(highest, 103);
  EXPECT_LT(highest, 114.6);  // 2 radians: what the examples reach
  for (std::size_t k = made.postures.size(); k < 400; ++k) {
    EXPECT_LE(largest_turn(clip.poses[k - 1], clip.poses[k]), made.largest_step + 1e-9) << "frame " << k + 1;
  }
  for (const JointCoverage& covered : coverage(clip.poses, examples, arm().character)) EXPECT_LT(covered.largest, 3);
  double turned = 0;  // joints deviate from examples, too
  for (const Pose& pose : range_of_motion(arm().character, limits(), {400, 3, examples}).blends) {
    const Quat bound = skeleton().joints[joint("fingers")].bind.rotation;
    turned = std::max(turned, angle_of(conjugate(bound) * pose.joints[joint("fingers")].rotation));
  }
  EXPECT_GT(turned, 15);
  EXPECT_LT(turned, 25 + 1e-6);
}

// Between an arm on one side of the torso and one on the other lie poses that go through it.
TEST(BlendClips, LimbsOverlapNoMoreThanInTheExamples) {
  const Quat bind = skeleton().joints[joint("shoulder")].bind.rotation;
  std::vector<Pose> examples(2, bind_pose(skeleton()));
  examples[0].joints[joint("shoulder")].rotation = axis_angle({0, 0, 1}, 1.5) * bind;
  examples[1].joints[joint("shoulder")].rotation = axis_angle({0, 0, 1}, -0.6) * bind;
  SelfOverlap overlap(arm().character);
  for (const Pose& pose : examples) overlap.trust(pose);
  Pose between = examples[0];
  between.joints[joint("shoulder")].rotation =
      slerp(examples[0].joints[joint("shoulder")].rotation, examples[1].joints[joint("shoulder")].rotation, 0.5);
  ASSERT_TRUE(overlap.find(between));
  for (const Pose& pose : blend_clips(examples, overlap, {bind_pose(skeleton())}, {50, 1, 20})) {
    ASSERT_FALSE(overlap.find(pose));
  }
}

TEST(BodySpheres, LieInsideTheSkinAndFillTheLimb) {
  const std::vector<BodySphere> spheres = body_spheres(arm().character);
  double thickest = 0;
  for (const BodySphere& sphere : spheres) {
    const Eigen::RowVector3d centre(sphere.centre[0], sphere.centre[1], sphere.centre[2]);
    const double gap = std::sqrt((arm().character.vertices.rowwise() - centre).rowwise().squaredNorm().minCoeff());
    EXPECT_GT(gap, 0.99 * sphere.radius);
    if (sphere.joint == joint("shoulder")) thickest = std::max(thickest, sphere.radius);
  }
  EXPECT_NEAR(thickest, 0.05, 0.02);  // an upper arm
}

TEST(SelfOverlap, SeesTheHandInTheTorso) {
  const SelfOverlap overlap(arm().character);
  Pose pose = bind_pose(skeleton());
  EXPECT_FALSE(overlap.find(pose));
  pose.joints[joint("shoulder")].rotation = axis_angle({0, 0, 1}, 0.9);  // the arm, hanging, pushed into the ribs
  EXPECT_TRUE(overlap.find(pose));
}

}  // namespace
}  // namespace bodyopt::trainer
