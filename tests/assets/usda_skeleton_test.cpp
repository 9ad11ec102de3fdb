// A skeleton as UsdSkel, read by its text: its joints stand where those of the clip stand.
#include "assets/caches/usda_skeleton.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "assets/caches/motion_write.h"
#include "runtime/host/rig.h"
#include "tests/support/error_kind.h"
#include "tests/support/hostile_bytes.h"
#include "tests/support/temporary_folder.h"

namespace bodyopt::testing {
namespace usda_skeleton_test {

// A joint that stands and one that is bent below it, by names that USD does not take and that become the same.
Skeleton arm() {
  Skeleton skeleton;
  for (const char* name : {"root", "1 arm.L", "1 arm_L"}) {
    Joint joint;
    joint.name = name;
    joint.parent = name[0] == 'r' ? -1 : 0;
    joint.bind.translation = {0.25, name[0] == 'r' ? 1.0 : 0.5, 0};
    joint.bind.rotation = axis_angle({0, 1, 0}, 0.5);
    joint.default_local = joint.bind;
    skeleton.joints.push_back(joint);
  }
  const std::vector<Affine> bind = posed_joints(skeleton, bind_pose(skeleton).joints);
  for (std::size_t j = 0; j < bind.size(); ++j) skeleton.joints[j].inverse_bind = inverse(bind[j]);
  return skeleton;
}

Clip bending(const Skeleton& skeleton) {
  Clip clip;
  clip.name = "take 1";
  clip.fps = 25;
  clip.first_frame = 1001;
  for (int k = 0; k < 3; ++k) {
    Pose pose = bind_pose(skeleton);
    pose.joints[1].rotation = axis_angle({0, 0, 1}, 0.3 * k);
    pose.joints[0].translation[2] = 0.125 * k;
    clip.poses.push_back(pose);
  }
  return clip;
}

// The numbers after the first `what`, to the end of the line.
std::vector<double> numbers_after(const std::string& text, const std::string& what) {
  const std::size_t found = text.find(what);
  EXPECT_NE(found, std::string::npos) << what;
  if (found == std::string::npos) return {};
  const std::size_t begin = found + what.size();
  const std::string line = text.substr(begin, text.find('\n', begin) - begin);
  std::vector<double> numbers;
  for (std::size_t at = 0; (at = line.find_first_of("-0123456789", at)) != std::string::npos;) {
    char* end = nullptr;
    numbers.push_back(std::strtod(line.c_str() + at, &end));
    at = static_cast<std::size_t>(end - line.c_str());
  }
  return numbers;
}

TEST(UsdSkeleton, HasEveryJointOfEveryFrame) {
  const TemporaryFolder folder;
  const Skeleton skeleton = arm();
  const Clip clip = bending(skeleton);
  write_motion(clip, skeleton, 0.01, folder / "take.usda");
  const std::string text = read_bytes(folder / "take.usda");
  for (const char* part :
       {"#usda 1.0\n", "defaultPrim = \"take_1\"", "startTimeCode = 1001\n", "endTimeCode = 1003\n",
        "timeCodesPerSecond = 25\n", "metersPerUnit = 1\n", "upAxis = \"Y\"", "def SkelRoot \"take_1\"",
        "joints = [\"root\", \"root/_1_arm_L\", \"root/_1_arm_L_2\"]", "rel skel:animationSource = </take_1/motion>"}) {
    EXPECT_NE(text.find(part), std::string::npos) << part;
  }
  const std::vector<Affine> bind = posed_joints(skeleton, bind_pose(skeleton).joints);
  const std::vector<double> written = numbers_after(text, "bindTransforms = ");
  ASSERT_EQ(written.size(), 48u);
  for (std::size_t k = 0; k < 48; ++k) {  // rows of the transposed matrix
    const std::size_t column = k % 16 / 4, row = k % 4;
    EXPECT_NEAR(written[k], row < 3 ? bind[k / 16].m[row][column] : column == 3 ? 1.0 : 0.0, 1e-6) << k;
  }
  const std::string places = text.substr(text.find("translations.timeSamples")),
                    turns = text.substr(text.find("rotations.timeSamples"));
  for (int k = 0; k < 3; ++k) {
    const std::string frame = "            " + std::to_string(1001 + k) + ": ";
    const std::vector<double> place = numbers_after(places, frame), turn = numbers_after(turns, frame);
    ASSERT_EQ(place.size(), 9u);
    ASSERT_EQ(turn.size(), 12u);
    EXPECT_NEAR(place[2], 0.125 * k, 1e-6);
    EXPECT_NEAR(turn[4], std::cos(0.15 * k), 1e-6);  // the real part first
    EXPECT_NEAR(turn[7], std::sin(0.15 * k), 1e-6);
  }
}

TEST(UsdSkeleton, OfNumbersThatAreNotFiniteIsNotWritten) {
  const TemporaryFolder folder;
  const Skeleton skeleton = arm();
  Clip clip = bending(skeleton);
  clip.poses[1].joints[2].scale[0] = INFINITY;
  EXPECT_EQ(kind_of([&] { write_motion(clip, skeleton, 1, folder / "take.usda"); }), ErrorKind::file);
  clip.poses.clear();
  EXPECT_EQ(kind_of([&] { write_motion(clip, skeleton, 1, folder / "take.usda"); }), ErrorKind::file);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace usda_skeleton_test
}  // namespace bodyopt::testing
