
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "runtime/basis/skeleton.h"
#include "runtime/host/rig.h"
#include "shots/session/pinned_joints.h"
#include "tests/support/random_tables.h"

namespace bodyopt::testing {
namespace {

using namespace shots;

Quat random_turn(Random& random) {
  return normalized({random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)});
}

// Two arms that are each other's mirror image at x = 0, of joints that are turned in any way: a shoulder, and two
// fingertips on each, which tell every turn of the shoulder apart.
Skeleton two_arms(Random& random) {
  Skeleton skeleton;
  const auto add = [&](const std::string& name, int parent, const Vec3& at) {
    JointTransform world;
    world.translation = at;
    world.rotation = random_turn(random);
    Joint joint;
    joint.name = name;
    joint.parent = parent;
    joint.inverse_bind = inverse(affine_from(world));
    const Affine above = parent < 0 ? Affine{} : skeleton.joints[static_cast<std::size_t>(parent)].inverse_bind;
    joint.bind = joint.default_local = decompose(above * affine_from(world));
    skeleton.joints.push_back(joint);
  };
  add("Spine", -1, {0, 1, 0.1});
  for (const double side : {1.0, -1.0}) {
    const std::string name = side > 0 ? "Left" : "Right";
    const int shoulder = static_cast<int>(skeleton.size());
    add(name + "Arm", 0, {0.2 * side, 1.4, 0.05});
    add(name + "Thumb", shoulder, {0.7 * side, 1.3, 0.3});
    add(name + "Finger", shoulder, {0.8 * side, 1.1, -0.1});
  }
  return skeleton;
}

Vec3 place_of(const Affine& joint) { return {joint.m[0][3], joint.m[1][3], joint.m[2][3]}; }

TEST(MirroredAngles, MakesThePoseTheMirrorImage) {
  Random random(7);
  for (int k = 0; k < 50; ++k) {
    const Skeleton skeleton = two_arms(random);
    const auto axes = [&](const char* name) {
      const Joint& joint = skeleton.joints[static_cast<std::size_t>(skeleton.find(name))];
      return decompose(inverse(joint.inverse_bind)).rotation;
    };
    const Vec3 angles{random.uniform(-180, 180), random.uniform(-180, 180), random.uniform(-180, 180)};
    const Vec3 mirrored = mirrored_angles(angles, axes("LeftArm"), axes("RightArm"));
    std::vector<JointTransform> pose = bind_pose(skeleton).joints;
    for (const auto& [name, degrees] : {std::pair{"LeftArm", angles}, {"RightArm", mirrored}}) {
      Quat& rotation = pose[static_cast<std::size_t>(skeleton.find(name))].rotation;
      rotation = normalized(rotation * turn_of(degrees));
    }
    const std::vector<Affine> posed = posed_joints(skeleton, pose);
    for (const std::string part : {"Arm", "Thumb", "Finger"}) {
      const Vec3 left = place_of(posed[static_cast<std::size_t>(skeleton.find("Left" + part))]);
      const Vec3 right = place_of(posed[static_cast<std::size_t>(skeleton.find("Right" + part))]);
      EXPECT_LT(length(right - Vec3{-left[0], left[1], left[2]}), 1e-9) << part;
    }
    // And back.
    const Vec3 back = mirrored_angles(mirrored, axes("RightArm"), axes("LeftArm"));
    EXPECT_LT(length(rotate(turn_of(back), {1, 2, 3}) - rotate(turn_of(angles), {1, 2, 3})), 1e-9);
  }
}

TEST(EulerAngles, AreThoseThatWereGiven) {
  const Quat none{0, 0, 0, 1};
  for (const Vec3& degrees : {Vec3{10, 20, -30}, Vec3{0, 90, 0}, Vec3{0, -90, 25}, Vec3{170, 5, 0}, Vec3{0, 120, 0}}) {
    const Vec3 found = degrees_of(turn_of(degrees));
    EXPECT_LT(length(found - degrees), 1e-5) << degrees[0] << " " << degrees[1] << " " << degrees[2];
    EXPECT_LT(length(mirrored_angles(degrees, none, none) - Vec3{degrees[0], -degrees[1], -degrees[2]}), 1e-5);
  }
}

}  // namespace
}  // namespace bodyopt::testing
