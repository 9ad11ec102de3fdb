// Two-bone reach against the geometry it promises; pins through posing, keys, limits and the mouse.
#include "shots/session/pinned_joints.h"

#include <gtest/gtest.h>

#include "proxy_viewer/picking.h"
#include "proxy_viewer/scene/scene.h"
#include "proxy_viewer/scene/turn_rings.h"
#include "runtime/core/error.h"
#include "runtime/host/rig.h"
#include "runtime/modifiers/drive_modifiers.h"
#include "shots/session/posed_clip.h"
#include "tests/proxy_viewer/played_viewport.h"
#include "tests/support/random_tables.h"

namespace bodyopt::testing {
namespace {

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
  const Pose held = posed(skeleton, {}, {}, moved, posing);
  EXPECT_LT(length(centre_of(skeleton, held, 3) - posing.pins["joint3"]), 1e-9);
  const Quat turned = conjugate(world_rotations(skeleton, moved)[3]) * world_rotations(skeleton, held)[3];
  EXPECT_NEAR(std::abs(turned[3]), 1, 1e-9);
  EXPECT_EQ(held.joints[0].translation, moved.joints[0].translation);
  // Those above are none of it, and who has no limb is left alone.
  ViewSettings::PoseKey none;
  none.pins["joint1"] = {9, 9, 9};
  none.pins["nobody"] = {9, 9, 9};
  const Pose same = posed(skeleton, {}, {}, moved, none);
  for (std::size_t j = 0; j < 4; ++j) EXPECT_EQ(same.joints[j].rotation, moved.joints[j].rotation);
}

TEST(Pins, StopAtTheLimits) {
  const Skeleton skeleton = chain();
  ViewSettings::PoseKey posing;
  posing.pins["joint3"] = {0, 0.5, 0.2};
  const double stiff = 10;
  const std::vector<std::optional<JointRange>> ranges(4, JointRange{{-stiff, -stiff, -stiff}, {stiff, stiff, stiff}});
  const Pose held = posed(skeleton, {}, ranges, bind_pose(skeleton), posing);
  for (std::size_t j = 1; j < 3; ++j) {
    EXPECT_LT(2 * std::acos(std::min(1.0, std::abs(held.joints[j].rotation[3]))), 1.75 * stiff * 0.01745) << j;
  }
  EXPECT_GT(length(centre_of(skeleton, held, 3) - posing.pins["joint3"]), 0.1);
}

TEST(Pins, ThatAreMissedSayByHowMuchAndWhy) {
  const Skeleton skeleton = chain();
  const Pose bind = bind_pose(skeleton);
  const std::vector<std::optional<JointRange>> stiff(4, JointRange{{-10, -10, -10}, {10, 10, 10}});
  EXPECT_TRUE(missed_pins(skeleton, {}, bind, {{"joint3", {0, 0.5, 0.2}}}).empty());
  const std::vector<MissedPin> held = missed_pins(skeleton, stiff, bind, {{"joint3", {0, 0.5, 0.2}}});
  ASSERT_EQ(held.size(), 1u);
  EXPECT_TRUE(held[0].by_limits);
  ViewSettings::PoseKey posing;
  posing.pins["joint3"] = {0, 0.5, 0.2};
  const Pose reached = posed(skeleton, {}, stiff, bind, posing);
  EXPECT_NEAR(held[0].away, length(centre_of(skeleton, reached, 3) - Vec3{0, 0.5, 0.2}), 1e-12);
  // The limb hangs at 0.4 and is 0.803 long.
  const std::vector<MissedPin> far = missed_pins(skeleton, {}, bind, {{"joint3", {0, 5, 0}}, {"nobody", {0, 0, 0}}});
  ASSERT_EQ(far.size(), 1u);
  EXPECT_FALSE(far[0].by_limits);
  EXPECT_NEAR(far[0].away, 5 - 0.4 - 0.4 - std::hypot(0.4, 0.05), 1e-3);
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

TEST_F(PosingTest, PinsAreKeptByKeysAndRefusedWhereNothingCanReach) {
  ::testing::internal::CaptureStderr();
  const auto viewport = open(limb(), kBarePicture + "; pin joint0; frame 2; key; move-key 2 7; move-key 3 4");
  const std::string said = ::testing::internal::GetCapturedStderr();
  EXPECT_NE(said.find("no two joints above"), std::string::npos) << said;
  EXPECT_NE(said.find("a frame that has a key"), std::string::npos) << said;
  ASSERT_EQ(viewport->controls().settings.pose.keys.size(), 1u);
  EXPECT_TRUE(viewport->controls().settings.pose.keys.contains(7));
}

}  // namespace
}  // namespace bodyopt::testing
