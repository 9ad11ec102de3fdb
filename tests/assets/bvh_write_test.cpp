#include <gtest/gtest.h>

#include "assets/bvh.h"
#include "assets/bvh_clip.h"
#include "runtime/host/rig.h"
#include "tests/support/error_kind.h"
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

TEST(WriteBvh, EveryJointIsWhereTheClipHasIt) {
  const TemporaryFolder folder;
  const Skeleton skeleton = small_basis().skeleton;
  const Clip clip = turning_clip(skeleton);
  write_bvh(clip, skeleton, folder / "clip.bvh");
  const Bvh bvh = read_bvh(folder / "clip.bvh");
  ASSERT_EQ(bvh.joints.size(), skeleton.size());
  ASSERT_EQ(bvh.frame_count, clip.poses.size());
  EXPECT_NEAR(bvh.frame_time, 1.0 / 30, 1e-9);
  for (std::size_t k = 0; k < clip.poses.size(); ++k) {
    for (std::size_t j = 0; j < skeleton.size(); ++j) {
      const JointTransform read = bvh.local(j, k), &own = clip.poses[k].joints[j];
      const auto a = rotation_matrix(read.rotation), b = rotation_matrix(own.rotation);
      for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_NEAR(read.translation[i], own.translation[i], 1e-6) << k << " " << j;
        for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(a[i][c], b[i][c], 1e-6) << k << " " << j;
      }
    }
  }
}

TEST(WriteBvh, RefusesWhatABvhCannotHold) {
  const TemporaryFolder folder;
  Skeleton skeleton = small_basis().skeleton;
  Clip clip = turning_clip(skeleton);
  skeleton.joints[1].parent = -1;
  EXPECT_EQ(kind_of([&] { write_bvh(clip, skeleton, folder / "clip.bvh"); }), ErrorKind::file);
  EXPECT_FALSE(std::filesystem::exists(folder / "clip.bvh"));
}

}  // namespace bvh_write_test
}  // namespace bodyopt::testing
