#include <gtest/gtest.h>

#include "assets/characters/character.h"
#include "assets/clips/bvh_clip.h"
#include "runtime/host/rig.h"
#include "tests/support/error_kind.h"
#include "tests/support/random_tables.h"
#include "tests/support/shared_data.h"
#include "tests/support/small_basis.h"
#include "tests/support/temporary_folder.h"

namespace bodyopt::testing {
namespace bvh_write_test {

// Joints that turn any way, also straight up, where two angles are one; the second is moved, too.
Clip turning_clip(const Skeleton& skeleton) {
  Random random(4);
  Clip clip;
  clip.name = "turns";
  clip.fps = 30;
  for (int k = 0; k < 20; ++k) {
    Pose pose = bind_pose(skeleton);
    for (JointTransform& joint : pose.joints) joint.rotation = random.turn(3);
    pose.joints[0].translation = {random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(-2, 2)};
    pose.joints[1].translation[1] += random.uniform(-0.1, 0.1);
    clip.poses.push_back(pose);
  }
  clip.poses[3].joints[1].rotation = axis_angle({1, 0, 0}, std::acos(0.0));
  clip.poses[4].joints[1].rotation = axis_angle({1, 0, 0}, -std::acos(0.0)) * axis_angle({0, 1, 0}, 0.5);
  return clip;
}

Affine world(const Skeleton& skeleton, const Pose& pose, std::size_t joint) {
  return posed_joints(skeleton, pose.joints)[joint];
}

// `apart`: metres, and of the axes of joints.
void expect_reads_as_written(const Clip& clip, const Skeleton& skeleton, double apart) {
  const TemporaryFolder folder;
  write_bvh(clip, skeleton, folder / "clip.bvh");
  const Clip again = read_clip((folder / "clip.bvh").string(), skeleton, {.fps = clip.fps});
  ASSERT_EQ(again.poses.size(), clip.poses.size());
  EXPECT_EQ(again.notes, (std::vector<std::string>{"One BVH unit is taken as 1 m, from the length of the bones."}));
  for (std::size_t k = 0; k < clip.poses.size(); ++k) {
    for (std::size_t j = 0; j < skeleton.size(); ++j) {
      const Affine read = world(skeleton, again.poses[k], j), own = world(skeleton, clip.poses[k], j);
      for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t c = 0; c < 4; ++c) ASSERT_NEAR(read.m[i][c], own.m[i][c], apart) << k << " " << j;
      }
    }
  }
}

TEST(WriteBvh, EveryJointIsWhereTheClipHasItWhenItIsReadAgain) {
  const Skeleton skeleton = small_basis().skeleton;
  expect_reads_as_written(turning_clip(skeleton), skeleton, 1e-6);
}

// Bound lying in axes of its own, which its nodes stand upright: read again it is turned no further.
TEST(WriteBvh, ACharacterThatLiesAtBindStandsInTheFile) {
  Skeleton skeleton = small_basis().skeleton;
  const Quat lie = axis_angle({1, 0, 0}, std::acos(0.0));
  skeleton.joints[0].default_local = skeleton.joints[0].bind;
  skeleton.joints[0].bind.rotation = lie * skeleton.joints[0].bind.rotation;
  skeleton.joints[0].bind.translation = {0.3, -0.2, 1};
  expect_reads_as_written(turning_clip(skeleton), skeleton, 1e-6);
}

// Of these all joints, from the root on, have axes of their own.
TEST(WriteBvh, RealAnimalsReadAsWritten) {
  constexpr double kScaled = 5e-5;  // as far as the horse's clip scales a joint, by rounding
  for (const auto& [file, motion, unit] :
       {std::tuple("characters/mesh2motion_horse.glb", "Trot", 0.0), std::tuple("characters/fox.glb", "Run", 0.01)}) {
    const auto path = shared_data(file);
    if (!path) GTEST_SKIP() << kNeedsOtherWriters;
    const Skeleton skeleton = read_character(*path, unit).skeleton;
    SCOPED_TRACE(file);
    expect_reads_as_written(read_clip(path->string() + "#" + motion, skeleton, {.unit = unit}), skeleton, kScaled);
  }
}

TEST(WriteBvh, RefusesWhatABvhCannotHold) {
  const TemporaryFolder folder;
  Skeleton skeleton = small_basis().skeleton;
  Clip clip = turning_clip(skeleton);
  skeleton.joints[1].parent = -1;
  EXPECT_EQ(kind_of([&] { write_bvh(clip, skeleton, folder / "clip.bvh"); }), ErrorKind::file);
  skeleton.joints[1].parent = 0;
  clip.poses[7].joints[1].scale = {1, 1.2, 1};
  EXPECT_EQ(kind_of([&] { write_bvh(clip, skeleton, folder / "clip.bvh"); }), ErrorKind::file);
  EXPECT_FALSE(std::filesystem::exists(folder / "clip.bvh"));
}

}  // namespace bvh_write_test
}  // namespace bodyopt::testing
