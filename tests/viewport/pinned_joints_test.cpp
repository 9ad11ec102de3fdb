// Two-bone reach against the geometry it promises; pins through posing, keys, limits and the mouse.
#include "shots/session/pinned_joints.h"

#include <gtest/gtest.h>

#include "assets/characters/character.h"
#include "runtime/core/error.h"
#include "runtime/host/rig.h"
#include "runtime/modifiers/drive_modifiers.h"
#include "shots/session/posed_clip.h"
#include "tests/support/paths.h"
#include "tests/support/random_tables.h"
#include "tests/support/run_verb.h"
#include "tests/support/shared_data.h"
#include "tests/viewport/played_viewport.h"
#include "viewport/picking.h"
#include "viewport/scene/scene.h"
#include "viewport/scene/turn_rings.h"

namespace bodyopt::testing {
namespace {

using namespace trainer;
using namespace shots;
using namespace viewport;

Vec3 any_point(Random& random, double size) {
  return {random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size)};
}

TEST(Reach, EndsAtTheTargetInThePlaneOfTheLimbAndBonesKeepTheirLength) {
  Random random{7};
  for (int k = 0; k < 300; ++k) {
    const Vec3 a = any_point(random, 2), b = a + any_point(random, 0.5), c = b + any_point(random, 0.5);
    const Vec3 target = a + any_point(random, 0.8);
    const double above = length(b - a), below = length(c - b), away = length(target - a);
    const LimbTurns turns = reach(a, b, c, target, {1, 0, 0});
    const Vec3 bent = b + rotate(turns.lower, c - b);
    const Vec3 middle = a + rotate(turns.upper, b - a), end = a + rotate(turns.upper, bent - a);
    EXPECT_NEAR(length(middle - a), above, 1e-12);
    EXPECT_NEAR(length(end - middle), below, 1e-12);
    EXPECT_NEAR(dot(bent - a, cross(b - a, c - b)), 0, 1e-12) << "it bends in its plane";
    if (std::abs(above - below) < away && away < above + below) {
      EXPECT_LT(length(end - target), 1e-9) << k;
    } else {  // it points there
      EXPECT_LT(length(cross(end - a, target - a)), 1e-7 * away) << k;
      EXPECT_NEAR(length(end - a), std::clamp(away, std::abs(above - below), above + below), 1e-7);
    }
  }
}

TEST(Reach, AStraightLimbBendsAboutTheHinge) {
  const LimbTurns turns = reach({0, 0, 0}, {0, -1, 0}, {0, -2, 0}, {0, -1, 0}, {1, 0, 0});
  const Vec3 bent = Vec3{0, -1, 0} + rotate(turns.lower, {0, -1, 0});
  const Vec3 end = rotate(turns.upper, bent);
  EXPECT_LT(length(end - Vec3{0, -1, 0}), 1e-9);
  EXPECT_NEAR(rotate(turns.upper, {0, -1, 0})[0], 0, 1e-12);
}

// A chain of four along y; the third and fourth end limbs.
Skeleton chain() {
  Skeleton skeleton;
  for (int j = 0; j < 4; ++j) {
    Joint joint;
    joint.name = "joint" + std::to_string(j);
    joint.parent = j - 1;
    joint.bind.translation = {0, j == 0 ? 0.0 : 0.4, j == 2 ? 0.05 : 0.0};
    skeleton.joints.push_back(joint);
  }
  return skeleton;
}

Vec3 centre_of(const Skeleton& skeleton, const Pose& pose, std::size_t joint) {
  const Affine at = posed_joints(skeleton, pose.joints)[joint];
  return {at.m[0][3], at.m[1][3], at.m[2][3]};
}

TEST(Pins, HoldAnEndAndItsOrientationWhileTheBodyMoves) {
  const Skeleton skeleton = chain();
  const Pose bind = bind_pose(skeleton);
  ViewSettings::PoseKey posing;
  posing.pins["joint3"] = centre_of(skeleton, bind, 3) + Vec3{0.05, -0.1, 0.02};
  Pose moved = bind;
  moved.joints[0].translation = {0.06, 0.04, -0.03};
  moved.joints[0].rotation = axis_angle({0, 0, 1}, 0.2);
  const Pose held = posed(skeleton, {}, moved, posing);
  EXPECT_LT(length(centre_of(skeleton, held, 3) - posing.pins["joint3"]), 1e-9);
  const Quat turned = conjugate(world_rotations(skeleton, moved)[3]) * world_rotations(skeleton, held)[3];
  EXPECT_NEAR(std::abs(turned[3]), 1, 1e-9);
  EXPECT_EQ(held.joints[0].translation, moved.joints[0].translation);
  // Those above are none of it, and who has no limb is left alone.
  ViewSettings::PoseKey none;
  none.pins["joint1"] = {9, 9, 9};
  none.pins["nobody"] = {9, 9, 9};
  const Pose same = posed(skeleton, {}, moved, none);
  for (std::size_t j = 0; j < 4; ++j) EXPECT_EQ(same.joints[j].rotation, moved.joints[j].rotation);
}

TEST(Pins, StopAtTheLimits) {
  const Skeleton skeleton = chain();
  ViewSettings::PoseKey posing;
  posing.pins["joint3"] = {0, 0.5, 0.2};
  const double stiff = 10;
  const std::vector<std::optional<JointRange>> ranges(4, JointRange{{-stiff, -stiff, -stiff}, {stiff, stiff, stiff}});
  const Pose held = posed(skeleton, {{}, ranges}, bind_pose(skeleton), posing);
  for (std::size_t j = 1; j < 3; ++j) {
    EXPECT_LT(2 * std::acos(std::min(1.0, std::abs(held.joints[j].rotation[3]))), 1.75 * stiff * 0.01745) << j;
  }
  EXPECT_GT(length(centre_of(skeleton, held, 3) - posing.pins["joint3"]), 0.1);
}

TEST(Pins, ThatAreMissedSayByHowMuchAndWhy) {
  const Skeleton skeleton = chain();
  const Pose bind = bind_pose(skeleton);
  const std::vector<std::optional<JointRange>> stiff(4, JointRange{{-10, -10, -10}, {10, 10, 10}});
  EXPECT_TRUE(missed_pins(skeleton, {}, bind, Pins{{{"joint3", {0, 0.5, 0.2}}}}).empty());
  const std::vector<MissedPin> held = missed_pins(skeleton, stiff, bind, Pins{{{"joint3", {0, 0.5, 0.2}}}});
  ASSERT_EQ(held.size(), 1u);
  EXPECT_TRUE(held[0].by_limits);
  ViewSettings::PoseKey posing;
  posing.pins["joint3"] = {0, 0.5, 0.2};
  const Pose reached = posed(skeleton, {{}, stiff}, bind, posing);
  EXPECT_NEAR(held[0].away, length(centre_of(skeleton, reached, 3) - Vec3{0, 0.5, 0.2}), 1e-12);
  // The limb hangs at 0.4 and is 0.803 long.
  const std::vector<MissedPin> far =
      missed_pins(skeleton, {}, bind, Pins{{{"joint3", {0, 5, 0}}, {"nobody", {0, 0, 0}}}});
  ASSERT_EQ(far.size(), 1u);
  EXPECT_FALSE(far[0].by_limits);
  EXPECT_NEAR(far[0].away, 5 - 0.4 - 0.4 - std::hypot(0.4, 0.05), 1e-3);
}

// Hips, a thigh, a shin, a foot, and a toe before it; the knee is a little bent to the front.
Skeleton leg() {
  Skeleton skeleton;
  const Vec3 places[] = {{0, 0.9, 0}, {0, -0.02, 0}, {0, -0.42, 0.02}, {0, -0.42, -0.02}, {0, -0.04, 0.12}};
  const char* const names[] = {"Hips", "LeftUpLeg", "LeftLeg", "LeftFoot", "LeftToeBase"};
  Affine above;
  for (int j = 0; j < 5; ++j) {
    Joint joint;
    joint.name = names[j];
    joint.parent = j - 1;
    joint.bind.translation = places[j];
    above = above * affine_from(joint.bind);
    joint.inverse_bind = inverse(above);
    skeleton.joints.push_back(joint);
  }
  return skeleton;
}

// Squats, and turns: the foot stays where it was pinned, and as it stood.
TEST(Moves, OfTheHipsLeaveAPinnedFootOnTheGround) {
  const Skeleton skeleton = leg();
  const Pose bind = bind_pose(skeleton);
  ViewSettings::PoseKey posing;
  posing.pins["LeftFoot"] = centre_of(skeleton, bind, 3);
  posing.facing["LeftFoot"] = facing_of(skeleton, {}, bind, posing, 3);
  posing.moves["Hips"] = {0.05, -0.25, 0.1};
  posing.joints["Hips"] = {0, 25, 5};
  const Pose squat = posed(skeleton, {}, bind, posing);
  EXPECT_LT(length(centre_of(skeleton, squat, 0) - centre_of(skeleton, bind, 0) - posing.moves["Hips"]), 1e-12);
  EXPECT_LT(length(centre_of(skeleton, squat, 3) - centre_of(skeleton, bind, 3)), 1e-6);
  EXPECT_LT(length(centre_of(skeleton, squat, 4) - centre_of(skeleton, bind, 4)), 1e-6) << "it points where it did";
  EXPECT_GT(centre_of(skeleton, squat, 2)[2], 0.1) << "the knee goes to the front";
  EXPECT_TRUE(missed_pins(skeleton, {}, bind, posing).empty());
  // Turned by its own angles it turns against the ground.
  posing.joints["LeftFoot"] = {-20, 0, 0};
  EXPECT_GT(centre_of(skeleton, posed(skeleton, {}, bind, posing), 4)[1], centre_of(skeleton, bind, 4)[1] + 0.03);
}

TEST(Moves, AreAlongTheWorldsAxesWhateverIsAbove) {
  Skeleton skeleton = leg();
  Pose pose = bind_pose(skeleton);
  pose.joints[0].rotation = axis_angle({0, 0, 1}, 1.0);
  pose.joints[0].scale = {2, 2, 2};
  ViewSettings::PoseKey posing;
  posing.moves["LeftUpLeg"] = {0.1, 0.2, -0.3};
  const Vec3 before = centre_of(skeleton, pose, 1);
  const Vec3 after = centre_of(skeleton, posed(skeleton, {}, pose, posing), 1);
  EXPECT_LT(length(after - before - posing.moves["LeftUpLeg"]), 1e-12);
}

TEST(Pins, OfAToeHoldItAndTheHeelComesUpOnceTheLegIsTooShort) {
  const Skeleton skeleton = leg();
  const Pose bind = bind_pose(skeleton);
  ViewSettings::PoseKey posing;
  posing.pins["LeftToeBase"] = centre_of(skeleton, bind, 4);
  posing.facing["LeftToeBase"] = facing_of(skeleton, {}, bind, posing, 4);
  posing.moves["Hips"] = {0, -0.2, 0};
  const Pose squat = posed(skeleton, {}, bind, posing);
  EXPECT_LT(length(centre_of(skeleton, squat, 4) - posing.pins["LeftToeBase"]), 1e-6);
  EXPECT_LT(length(centre_of(skeleton, squat, 3) - centre_of(skeleton, bind, 3)), 1e-6) << "the heel stays down";
  posing.moves["Hips"] = {0, 0.03, 0.25};
  const Pose lifted = posed(skeleton, {}, bind, posing);
  EXPECT_LT(length(centre_of(skeleton, lifted, 4) - posing.pins["LeftToeBase"]), 2e-3);
  EXPECT_GT(centre_of(skeleton, lifted, 3)[1], centre_of(skeleton, bind, 3)[1] + 0.03);
}

// Poses a foot that is pinned where it stands, while the hips go down by 5 mm a step, to the depth.
std::vector<Pose> squats(const Skeleton& skeleton, const JointLimits& limits,
                         const std::vector<std::optional<JointRange>>& ranges, const std::vector<std::string>& feet,
                         const std::string& hips, double depth) {
  const Pose bind = bind_pose(skeleton);
  ViewSettings::PoseKey posing;
  for (const std::string& foot : feet) {
    const auto joint = static_cast<std::size_t>(skeleton.find(foot));
    posing.facing[foot] = facing_of(skeleton, {limits, ranges}, bind, posing, joint);
    posing.pins[foot] = centre_of(skeleton, bind, joint);
  }
  std::vector<Pose> poses;
  for (double down = 0; down <= depth; down += 0.005) {
    posing.moves[hips] = {0, -down, 0};
    poses.push_back(posed(skeleton, {limits, ranges}, bind, posing));
  }
  return poses;
}

double largest_turn(const Pose& a, const Pose& b) {
  double largest = 0;
  for (std::size_t j = 0; j < a.joints.size(); ++j) {
    largest = std::max(largest, angle_between(a.joints[j].rotation, b.joints[j].rotation));
  }
  return largest * 180 / std::numbers::pi;
}

TEST(Pins, OfAFootLetItsHeelUpWhereTheAnkleEnds) {
  const Skeleton skeleton = leg();
  std::vector<std::optional<JointRange>> ranges(5);
  ranges[3] = JointRange{{-20, -20, -20}, {20, 20, 20}};
  const Pose bind = bind_pose(skeleton);
  const std::vector<Pose> poses = squats(skeleton, {}, ranges, {"LeftFoot"}, "Hips", 0.35);
  const Vec3 toe = centre_of(skeleton, bind, 4), foot = centre_of(skeleton, bind, 3);
  for (std::size_t k = 0; k < poses.size(); ++k) {
    EXPECT_NEAR(centre_of(skeleton, poses[k], 4)[1], toe[1], 1e-5) << k;
    EXPECT_LT(length(centre_of(skeleton, poses[k], 4) - toe), 1e-3) << k;
    EXPECT_NEAR(angle_between(world_rotations(skeleton, poses[k])[4], {0, 0, 0, 1}), 0, 1e-6) << "the toe lies flat";
    if (k > 1) {
      EXPECT_LT(largest_turn(poses[k], poses[k - 1]), 8) << k;
    }
  }
  EXPECT_LT(length(centre_of(skeleton, poses[4], 3) - foot), 1e-6) << "as long as the ankle goes on";
  EXPECT_GT(centre_of(skeleton, poses.back(), 3)[1], foot[1] + 0.03);
  const std::vector<MissedPin> missed =
      missed_pins(skeleton, ranges, bind, Pins{{{"LeftFoot", foot + Vec3{0, 0.3, 0}}}, {{"LeftFoot", {0, 0, 0, 1}}}});
  ASSERT_EQ(missed.size(), 1u);
  EXPECT_TRUE(missed[0].on_toes);
  EXPECT_NE(describe(missed[0]).find("its heel is up by"), std::string::npos) << describe(missed[0]);
}

// Before the limb reaches, its shin leans: an orientation that is out of the ankle's range there may be within it
// after.
TEST(Pins, HoldAFootAsItStoodHoweverTheHipsTurn) {
  const Skeleton skeleton = leg();
  std::vector<std::optional<JointRange>> ranges(5);
  ranges[3] = JointRange{{-30, -30, -30}, {30, 30, 30}};
  const Pose bind = bind_pose(skeleton);
  Pose turned = bind;
  turned.joints[0].translation[1] -= 0.1;
  turned.joints[0].rotation = axis_angle({1, 0, 0}, 50 * std::numbers::pi / 180);
  const Pose held = pinned(skeleton, ranges, turned,
                           Pins{{{"LeftFoot", centre_of(skeleton, bind, 3)}}, {{"LeftFoot", {0, 0, 0, 1}}}});
  EXPECT_LT(length(centre_of(skeleton, held, 3) - centre_of(skeleton, bind, 3)), 1e-6);
  EXPECT_LT(length(centre_of(skeleton, held, 4) - centre_of(skeleton, bind, 4)), 1e-6);
}

TEST(Pins, OfAFootWithoutAToeSayHowFarItIsTipped) {
  Skeleton skeleton = leg();
  skeleton.joints.pop_back();
  std::vector<std::optional<JointRange>> ranges(4);
  ranges[3] = JointRange{{-10, -10, -10}, {10, 10, 10}};
  Pose low = bind_pose(skeleton);
  low.joints[0].translation[1] -= 0.25;
  const Pins pins{{{"LeftFoot", centre_of(skeleton, bind_pose(skeleton), 3)}}, {{"LeftFoot", {0, 0, 0, 1}}}};
  const std::vector<MissedPin> missed = missed_pins(skeleton, ranges, low, pins);
  ASSERT_EQ(missed.size(), 1u);
  EXPECT_LT(missed[0].away, 1e-6);
  const Quat facing = world_rotations(skeleton, pinned(skeleton, ranges, low, pins))[3];
  EXPECT_NEAR(missed[0].tipped, 180 / std::numbers::pi * angle_between(facing, {0, 0, 0, 1}), 1e-6);
  EXPECT_NE(describe(missed[0]).find("LeftFoot: tipped by"), std::string::npos);
}

// A person whose feet are not at the height 0, and beasts, with the limits that `rig` gives them.
TEST(Pins, KeepToesOfRealFeetOverTheGroundOrSaySo) {
  struct Case {
    const char *file, *unit, *hips;
    std::vector<std::string> feet;
    double depth;
  };
  const Case cases[] = {{"human_average", "0", "Hips", {"LeftFoot", "RightFoot"}, 0.4},
                        {"fox", "0.01", "_rootJoint", {"b_LeftFoot01_017", "b_RightFoot01_021"}, 0.15},
                        {"cesium_man", "0", "Skeleton_torso_joint_1", {"leg_joint_L_3", "leg_joint_R_3"}, 0.1},
                        {"mesh2motion_horse", "0", "root", {"back_leg_ankle_l", "back_leg_ankle_r"}, 0.1}};
  for (const Case& each : cases) {
    const auto file = shared_data(std::string("characters/") + each.file + ".glb");
    if (!file) GTEST_SKIP() << kNeedsRealBodies;
    const Skeleton skeleton = read_character(*file, std::stod(each.unit)).skeleton;
    const TemporaryFolder folder;
    std::string limits_file = kSourceFolder + "/rigs/human/limits.json";
    if (std::string(each.file) != "human_average") {
      const std::string unit = std::string(each.unit) == "0" ? "" : std::string(" --unit ") + each.unit;
      ASSERT_EQ(run_verb("rig " + file->string() + unit + " --out " + folder.path().string()).exit_code, 0);
      limits_file = (folder / "limits.json").string();
    }
    const JointLimits limits = read_joint_limits(limits_file, skeleton);
    const std::vector<std::optional<JointRange>> ranges = joint_ranges(limits, skeleton);
    const std::vector<Pose> poses = squats(skeleton, limits, ranges, each.feet, each.hips, each.depth);
    for (std::size_t k = 0; k < poses.size(); ++k) {
      if (k > 1) {
        EXPECT_LT(largest_turn(poses[k], poses[k - 1]), 10) << each.file << " " << k;
      }
      for (std::size_t j = 0; j < skeleton.size(); ++j) {
        const int foot = skeleton.joints[j].parent;
        if (foot < 0 ||
            std::ranges::find(each.feet, skeleton.joints[static_cast<std::size_t>(foot)].name) == each.feet.end())
          continue;
        const double missed =
            length(centre_of(skeleton, poses[k], static_cast<std::size_t>(foot)) -
                   centre_of(skeleton, poses.front(), static_cast<std::size_t>(foot)));  // which is told
        EXPECT_GT(centre_of(skeleton, poses[k], j)[1] - centre_of(skeleton, poses.front(), j)[1],
                  std::string(each.file) == "human_average" ? -1e-4 : -1e-3 - missed)
            << each.file << " " << k << " " << skeleton.joints[j].name;
      }
    }
  }
}

// Hips, a spine of three, neck, head, and an arm at the chest.
Skeleton torso() {
  Skeleton skeleton;
  const Vec3 places[] = {{0, 0.9, 0},    {0, 0.1, 0.01}, {0, 0.15, -0.02}, {0, 0.15, -0.01}, {0, 0.2, 0.02},
                         {0, 0.1, 0.02}, {0.18, 0.1, 0}, {0.25, -0.1, 0},  {0.2, -0.1, 0.05}};
  const char* const names[] = {"Hips", "Spine",   "Spine1",      "Spine2",  "Neck",
                               "Head", "LeftArm", "LeftForeArm", "LeftHand"};
  const int parents[] = {-1, 0, 1, 2, 3, 4, 3, 6, 7};
  std::vector<Affine> world;
  for (std::size_t j = 0; j < 9; ++j) {
    Joint joint;
    joint.name = names[j];
    joint.parent = parents[j];
    joint.bind.translation = places[j];
    const Affine own = affine_from(joint.bind);
    world.push_back(joint.parent < 0 ? own : world[static_cast<std::size_t>(joint.parent)] * own);
    joint.inverse_bind = inverse(world.back());
    skeleton.joints.push_back(joint);
  }
  return skeleton;
}

double degrees_turned(const Skeleton& skeleton, const Pose& pose, std::size_t joint) {
  return angle_between(pose.joints[joint].rotation, skeleton.joints[joint].bind.rotation) * 180 / std::numbers::pi;
}

TEST(SpinePins, BendAllOfTheSpineAndHandsHoldMeanwhile) {
  const Skeleton skeleton = torso();
  const Pose bind = bind_pose(skeleton);
  ViewSettings::PoseKey posing;
  posing.pins["Head"] = centre_of(skeleton, bind, 5) + Vec3{0.05, -0.06, 0.2};
  posing.pins["LeftHand"] = centre_of(skeleton, bind, 8);
  posing.facing["Head"] = facing_of(skeleton, {}, bind, posing, 5);
  const Pose bent = posed(skeleton, {}, bind, posing);
  EXPECT_LT(length(centre_of(skeleton, bent, 5) - posing.pins["Head"]), 1e-4);
  EXPECT_LT(length(centre_of(skeleton, bent, 8) - posing.pins["LeftHand"]), 1e-4);
  EXPECT_NEAR(angle_between(world_rotations(skeleton, bent)[5], world_rotations(skeleton, bind)[5]), 0, 1e-6);
  for (const std::size_t joint : {1, 2, 3}) {
    EXPECT_GT(degrees_turned(skeleton, bent, joint), 3) << joint;
    EXPECT_LT(degrees_turned(skeleton, bent, joint), 40) << joint;
  }
  EXPECT_EQ(bent.joints[0].rotation, bind.joints[0].rotation);
  EXPECT_TRUE(missed_pins(skeleton, {}, bind, posing).empty());
}

TEST(SpinePins, OfChestAndHeadBothHoldWhileTheHipsMove) {
  const Skeleton skeleton = torso();
  const Pose bind = bind_pose(skeleton);
  ViewSettings::PoseKey posing;
  for (const std::size_t joint : {3, 5}) {
    const std::string& name = skeleton.joints[joint].name;
    posing.facing[name] = facing_of(skeleton, {}, bind, posing, joint);
    posing.pins[name] = centre_of(skeleton, bind, joint);
  }
  posing.moves["Hips"] = {0.05, 0.03, 0.06};
  posing.joints["Hips"] = {10, 15, 0};
  const Pose held = posed(skeleton, {}, bind, posing);
  for (const std::size_t joint : {3, 5}) {
    EXPECT_LT(length(centre_of(skeleton, held, joint) - centre_of(skeleton, bind, joint)), 1e-4) << joint;
  }
}

TEST(SpinePins, StayWithinTheLimitsAndGoSmoothlyWithTheTarget) {
  const Skeleton skeleton = torso();
  const Pose bind = bind_pose(skeleton);
  const std::vector<std::optional<JointRange>> stiff(9, JointRange{{-6, -6, -6}, {6, 6, 6}});
  ViewSettings::PoseKey posing;
  Pose before;
  for (int k = 0; k <= 60; ++k) {  // beyond what it reaches, and what it may
    posing.pins["Head"] = centre_of(skeleton, bind, 5) + 0.01 * k * Vec3{0.3, -0.2, 1};
    for (const auto& ranges : {std::vector<std::optional<JointRange>>(), stiff}) {
      const Pose bent = posed(skeleton, {{}, ranges}, bind, posing);
      for (std::size_t j = 1; j < 5; ++j) {
        EXPECT_LT(degrees_turned(skeleton, bent, j), ranges.empty() ? 180 : 1.8 * 6) << j;
        if (k == 0 || !ranges.empty()) continue;
        EXPECT_LT(angle_between(bent.joints[j].rotation, before.joints[j].rotation), 0.15) << k << " " << j;
      }
      if (ranges.empty()) before = bent;
    }
  }
  const std::vector<MissedPin> missed = missed_pins(skeleton, {{}, stiff}, bind, posing);
  ASSERT_EQ(missed.size(), 1u);
  EXPECT_EQ(missed[0].joint, "Head");
  EXPECT_TRUE(missed[0].by_limits);
}

// Wherever a hand drags it, a centimetre a time, through the body and far beyond what it reaches.
TEST(SpinePins, ThatArePulledFarNeverJump) {
  const Skeleton skeleton = torso();
  const Pose bind = bind_pose(skeleton);
  const std::vector<std::optional<JointRange>> stiff(9, JointRange{{-25, -25, -25}, {25, 25, 25}});
  Random random{3};
  for (int ray = 0; ray < 24; ++ray) {
    Vec3 along = any_point(random, 1);
    along = 1 / length(along) * along;
    if (ray == 0) along = {0, -1, 0};
    for (const auto& ranges : {std::vector<std::optional<JointRange>>(), stiff}) {
      ViewSettings::PoseKey posing;
      posing.facing["Head"] = facing_of(skeleton, {}, bind, posing, 5);
      Pose before = bind;
      for (int k = 0; k <= 150; ++k) {
        posing.pins["Head"] = centre_of(skeleton, bind, 5) + 0.01 * k * along;
        const Pose bent = posed(skeleton, {{}, ranges}, bind, posing);
        EXPECT_LT(largest_turn(bent, before), 15) << "ray " << ray << " at " << k << " cm, ranges " << ranges.size();
        before = bent;
      }
    }
  }
}

// Overstretched by a degree at rest, as artists' rigs are.
TEST(Pins, BendAKneeToTheSideThatItsRangeHas) {
  Skeleton skeleton = leg();
  skeleton.joints[2].bind.translation[2] = skeleton.joints[3].bind.translation[2] = -0.005;
  skeleton.joints[3].bind.translation[2] = 0.005;
  const Pose bind = bind_pose(skeleton);
  std::vector<std::optional<JointRange>> ranges(5);
  ranges[2] = JointRange{{0, 0, 0}, {135, 0, 0}};
  ViewSettings::PoseKey posing;
  posing.pins["LeftFoot"] = centre_of(skeleton, bind, 3);
  posing.moves["Hips"] = {0, -0.25, 0};
  const Pose squat = posed(skeleton, {{}, ranges}, bind, posing);
  EXPECT_LT(length(centre_of(skeleton, squat, 3) - posing.pins["LeftFoot"]), 1e-3);
  EXPECT_GT(centre_of(skeleton, squat, 2)[2], 0.1);
}

// An elbow that a clip bends already goes no further than its limit by the slider that is named after it.
TEST(Axes, EndAtTheLimitTogetherWithTheClip) {
  const Skeleton skeleton = leg();
  const JointLimits limits{{{"hip_flexion", 0, -20, 120, {{1, {-1, 0, 0}}}},
                            {"hip_rotation", 0, -40, 40, {{1, {0, -1, 0}}}},
                            {"knee_flexion", 5, 0, 130, {{2, {1, 0, 0}}}}}};
  const std::vector<std::optional<JointRange>> ranges = joint_ranges(limits, skeleton);
  Pose clip = bind_pose(skeleton);
  clip.joints[1].rotation = axis_angle({-1, 0, 0}, 0.5) * axis_angle({0, -1, 0}, 0.3);
  clip.joints[2].rotation = axis_angle({1, 0, 0}, 40 * std::numbers::pi / 180);
  const auto free = [&](std::size_t k) { return free_angles(limits, skeleton, limits.dofs[k], clip); };
  EXPECT_NEAR(free(2).second, 130 - 5 - 40, 1e-6);
  EXPECT_NEAR(free(2).first, -5 - 40, 1e-6);
  EXPECT_NEAR(free(0).second, 120 - 0.5 * 180 / std::numbers::pi, 1e-3) << "of several axes each has its own angle";
  EXPECT_NEAR(free(1).second, 40 - 0.3 * 180 / std::numbers::pi, 1e-3);
  ViewSettings::PoseKey posing;
  posing.axes["knee_flexion"] = 110;
  const Pose bent = posed(skeleton, {limits, ranges}, clip, posing);
  EXPECT_NEAR(2 * std::acos(bent.joints[2].rotation[3]) * 180 / std::numbers::pi, 125, 1e-5);
  EXPECT_NEAR(2 * std::acos(posed(skeleton, {limits, {}}, clip, posing).joints[2].rotation[3]),
              150 * std::numbers::pi / 180, 1e-5)
      << "without ranges as far as it is turned";
  clip.joints[2].rotation = axis_angle({1, 0, 0}, 140 * std::numbers::pi / 180);
  EXPECT_EQ(free(2).second, 0) << "what the clip has beyond goes no further";
}

class PosingTest : public PlayedTest {
 protected:
  JigglingCharacter limb_{folder_};
  ViewerOptions limb() const {
    ViewerOptions options = small();
    options.files = {limb_.basis, limb_.clip};
    return options;
  }
};

TEST_F(PosingTest, ARingIsDraggedAndThatIsOneStepOfUndo) {
  const auto viewport = open(small(), kBarePicture + "; legend off; skeleton on; select upper; front; select upper");
  const std::vector<TurnRing> rings = turn_rings(viewport->session().scene, viewport->controls());
  ASSERT_EQ(rings.size(), 3u);
  for (const TurnRing& ring : rings) EXPECT_NEAR(length(ring.point(30) - ring.centre), ring.radius, 1e-9);
  const auto where = [&](double degrees) {
    const auto pixel =
        pixel_of(viewport->session().scene, viewport->controls(), {0, 0, 320, 180}, 160, rings[2].point(degrees));
    EXPECT_TRUE(pixel);
    return *pixel;
  };
  const OrbitView before = viewport->controls().camera.view();
  viewport->drag(0, where(200), {where(210), where(220), where(230)});
  ASSERT_TRUE(viewport->controls().settings.pose.joints.contains("upper"));
  EXPECT_NEAR(viewport->controls().settings.pose.joints.at("upper")[2], 30, 4);
  EXPECT_EQ(viewport->controls().camera.view(), before) << "the camera stays";
  viewport->key("Ctrl+Z");
  EXPECT_FALSE(viewport->controls().settings.pose.joints.contains("upper"));
}

TEST_F(PosingTest, AnArrowIsDraggedAndThatIsOneStepOfUndo) {
  const auto viewport = open(small(), kBarePicture + "; legend off; skeleton on; front; select lower");
  const std::vector<MoveArrow> arrows = move_arrows(viewport->session().scene, viewport->controls());
  ASSERT_EQ(arrows.size(), 3u);
  const auto where = [&](const Vec3& at) {
    const auto pixel = pixel_of(viewport->session().scene, viewport->controls(), {0, 0, 320, 180}, 160, at);
    EXPECT_TRUE(pixel);
    return *pixel;
  };
  const Vec3 along = arrows[1].to - arrows[1].from;
  const auto from = where(arrows[1].from + 0.9 * along), to = where(arrows[1].from + 1.9 * along);
  viewport->drag(0, from, {{to[0] + 20, to[1]}});
  ASSERT_TRUE(viewport->controls().settings.pose.moves.contains("lower"));
  const Vec3 moved = viewport->controls().settings.pose.moves.at("lower");
  EXPECT_NEAR(moved[1], length(along), 0.1 * length(along)) << "up, however the mouse went aside";
  EXPECT_EQ(moved[0], 0);
  EXPECT_TRUE(viewport->controls().is_posed("lower"));
  viewport->key("Ctrl+Z");
  EXPECT_TRUE(viewport->controls().settings.pose.moves.empty());
  // At its middle it is dragged in the plane of the picture.
  const auto middle = where(arrows[1].from);
  viewport->drag(0, middle, {{middle[0] + 30, middle[1]}});
  ASSERT_TRUE(viewport->controls().settings.pose.moves.contains("lower"));
  EXPECT_GT(viewport->controls().settings.pose.moves.at("lower")[0], 0.01);
}

TEST_F(PosingTest, AToolShowsWhatItDragsBy) {
  const auto viewport = open(small(), kBarePicture + "; skeleton on; select lower; keymap blender");
  const auto counts = [&] {
    const Scene& scene = viewport->session().scene;
    return std::pair(turn_rings(scene, viewport->controls()).size(), move_arrows(scene, viewport->controls()).size());
  };
  EXPECT_EQ(counts(), std::pair(std::size_t{3}, std::size_t{3}));
  viewport->key("G");
  EXPECT_EQ(counts(), std::pair(std::size_t{0}, std::size_t{3}));
  viewport->key("R");
  EXPECT_EQ(counts(), std::pair(std::size_t{3}, std::size_t{0}));
  viewport->key("R");
  EXPECT_EQ(counts(), std::pair(std::size_t{3}, std::size_t{3}));
}

TEST_F(PosingTest, PinsAreKeptByKeysAndRefusedWhereNothingCanReach) {
  ::testing::internal::CaptureStderr();
  const auto viewport = open(limb(), kBarePicture + "; pin joint0; frame 2; key; move-key 2 7; move-key 3 4");
  const std::string said = ::testing::internal::GetCapturedStderr();
  EXPECT_NE(said.find("no two joints above it that could reach for a pin; these have: joint"), std::string::npos)
      << said;
  EXPECT_NE(said.find("a frame that has a key"), std::string::npos) << said;
  ASSERT_EQ(viewport->controls().settings.pose.keys.size(), 1u);
  EXPECT_TRUE(viewport->controls().settings.pose.keys.contains(7));
}

}  // namespace
}  // namespace bodyopt::testing
