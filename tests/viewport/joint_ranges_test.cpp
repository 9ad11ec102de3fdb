#include <gtest/gtest.h>

#include <numbers>

#include "shots/session/pinned_joints.h"

namespace bodyopt::testing {
namespace {

using namespace trainer;
using namespace shots;

// A root, a limb whose own x axis is the world's y, and a limb without limits.
Skeleton three_joints() {
  Skeleton skeleton;
  for (const char* name : {"root", "limb", "free"}) {
    Joint joint;
    joint.name = name;
    joint.parent = static_cast<int>(skeleton.joints.size()) - 1;
    joint.inverse_bind = inverse(affine_from(joint.bind));
    skeleton.joints.push_back(joint);
  }
  JointTransform turned;
  turned.rotation = axis_angle({0, 0, 1}, std::numbers::pi / 2);
  skeleton.joints[1].inverse_bind = inverse(affine_from(turned));
  return skeleton;
}

std::vector<std::optional<JointRange>> ranges_with(const std::vector<DegreeOfFreedom>& dofs) {
  return joint_ranges({dofs}, three_joints());
}

void expect_near(const Vec3& actual, const Vec3& expected) { EXPECT_LT(length(actual - expected), 1e-9) << actual[0]; }

TEST(JointRanges, AreAboutTheJointsOwnAxesAndAwayFromRest) {
  const auto ranges =
      ranges_with({{"bend", 10, -30, 120, {{1, {0, 1, 0}, 0.5}}}, {"roll", 0, -20, 40, {{1, {0, 0, -1}, 1}}}});
  ASSERT_TRUE(ranges[1]);
  expect_near(ranges[1]->low, {-20, 0, -40});
  expect_near(ranges[1]->high, {55, 0, 20});
  EXPECT_FALSE(ranges[0]);
  EXPECT_FALSE(ranges[2]);
}

TEST(JointRanges, OfObliqueTurnsHaveAPartAlongEveryAxis) {
  const auto ranges = ranges_with({{"bend", 0, -10, 100, {{1, {0.6, 0.8, 0}, 1}}}});
  ASSERT_TRUE(ranges[1]);
  expect_near(ranges[1]->low, {-8, -60, 0});
  expect_near(ranges[1]->high, {80, 6, 0});
}

TEST(JointRanges, OfARootAreLeftAlone) {
  const auto ranges = ranges_with({{"tilt", 0, -1, 1, {{0, {1, 0, 0}, 1}}}});
  EXPECT_FALSE(ranges[0]);
}

// A joint that bends about x from -10 to 150 degrees, rolls about y by 30 either way and is held about z.
const JointRange kRange{{-10, -30, 0}, {150, 30, 0}};
const Quat kBind = axis_angle({0.6, 0, 0.8}, 0.7);

Quat posed(const Vec3& degrees) { return kBind * turn_of(degrees); }

// Its angles away from the bind pose.
Vec3 turned(const Vec3& clip, const Vec3& degrees) {
  return degrees_of(conjugate(kBind) * turned_within(kRange, kBind, posed(clip), degrees));
}

TEST(JointRanges, BindTheClipAndWhatIsAddedTogether) {
  expect_near(turned({100, 0, 0}, {40, 0, 0}), {140, 0, 0});
  expect_near(turned({100, 0, 0}, {90, 0, 0}), {150, 0, 0});
  expect_near(turned({100, 0, 0}, {-105, 0, 0}), {-5, 0, 0});
  expect_near(turned({100, 0, 0}, {-250, 0, 0}), {-10, 0, 0});
  expect_near(turned({0, 0, 0}, {20, 60, 50}), {20, 30, 0});
}

// However far another is bent: a roll of a bent joint is not taken for a turn about the axis that is held.
TEST(JointRanges, OfAnAxisThatIsFreeAreNotLostOnOneThatIsHeld) {
  for (const double bent : {40.0, 90.0, 140.0}) expect_near(turned({bent, 0, 0}, {0, 20, 0}), {bent, 20, 0});
}

TEST(JointRanges, LeaveAClipBeyondThemWhereItIsOrBringItBack) {
  const Vec3 beyond{-40, 5, 12};
  for (const Vec3& none : {Vec3{}, Vec3{-20, 0, 0}}) expect_near(turned(beyond, none), beyond);
  expect_near(turned(beyond, {25, 0, 0}), {-15, 5, 12});
  const Quat clip = posed(beyond);
  EXPECT_EQ(turned_within(kRange, kBind, clip, {}), normalized(clip)) << "to the last bit";
}

TEST(JointRanges, OfSlidersAreWhatTheClipLeaves) {
  const JointRange left = turns_within(kRange, kBind, posed({100, 0, 0}));
  expect_near(left.low, {-110, -30, 0});
  expect_near(left.high, {50, 30, 0});
  const JointRange beyond = turns_within(kRange, kBind, posed({-40, 0, 0}));
  expect_near(beyond.low, {0, -30, 0});
  expect_near(beyond.high, {190, 30, 0});
}

}  // namespace
}  // namespace bodyopt::testing
