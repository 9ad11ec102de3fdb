#include "proxy_viewer/joint_ranges.h"

#include <gtest/gtest.h>

#include <numbers>

namespace bodyopt::testing {
namespace {

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

std::vector<JointRow> rows_with(const std::vector<DegreeOfFreedom>& dofs) {
  std::vector<JointRow> rows(3);
  limit_joints({dofs}, three_joints(), rows);
  return rows;
}

void expect_near(const Vec3& actual, const Vec3& expected) { EXPECT_LT(length(actual - expected), 1e-9) << actual[0]; }

TEST(JointRanges, AreAboutTheJointsOwnAxesAndAwayFromRest) {
  const auto rows =
      rows_with({{"bend", 10, -30, 120, {{1, {0, 1, 0}, 0.5}}}, {"roll", 0, -20, 40, {{1, {0, 0, -1}, 1}}}});
  expect_near(rows[1].low, {-20, 0, -40});
  expect_near(rows[1].high, {55, 0, 20});
  for (const std::size_t untouched : {0u, 2u}) {
    EXPECT_EQ(rows[untouched].low, JointRow{}.low);
    EXPECT_EQ(rows[untouched].high, JointRow{}.high);
  }
}

TEST(JointRanges, OfObliqueTurnsHaveAPartAlongEveryAxis) {
  const auto rows = rows_with({{"bend", 0, -10, 100, {{1, {0.6, 0.8, 0}, 1}}}});
  expect_near(rows[1].low, {-8, -60, 0});
  expect_near(rows[1].high, {80, 6, 0});
}

TEST(JointRanges, OfARootAreLeftAlone) {
  const auto rows = rows_with({{"tilt", 0, -1, 1, {{0, {1, 0, 0}, 1}}}});
  EXPECT_EQ(rows[0].high, JointRow{}.high);
}

}  // namespace
}  // namespace bodyopt::testing
