#include "viewport/picking.h"

#include "tests/support/gpu_fixture.h"
#include "tests/viewport/small_character.h"

namespace bodyopt::testing {
namespace {

using namespace shots;
using namespace draw;
using namespace viewport;

class JointAt : public ::testing::Test {
 protected:
  JointAt() {
    scene.add({small.basis, small.clip}, {});
    controls.playback = Playback({1, kClipFrames}, 24);
  }

  const TemporaryFolder folder;
  const SmallCharacter small{folder};
  Scene scene{open_test_device()};
  Controls controls;
  const Rectangle area = {100, 40, 640, 360};
};

TEST_F(JointAt, IsTheOneThatIsSeenThere) {
  controls.playback.scrub(6);
  const std::vector<Vec3> centres = scene.joint_centres(controls);
  const std::vector<Joint>& joints = scene.lead().basis().skeleton.joints;
  for (const bool orthographic : {false, true}) {
    for (std::size_t j = 0; j < centres.size(); ++j) {
      controls.camera = OrbitCamera({centres[j], 0.2, 0.3, 0.1, orthographic});
      EXPECT_EQ(joint_at(scene, controls, area, 100 + 320 + 3, 40 + 180 - 3), joints[j].name) << orthographic;
      EXPECT_EQ(joint_at(scene, controls, area, 100, 40), "") << "far from all";
    }
  }
}

TEST_F(JointAt, IsThatOfTheViewUnderTheMouse) {
  controls.settings.compare.with = CompareWith::ddm;
  controls.camera = OrbitCamera({scene.joint_centres(controls)[1], 0.2, 0.3, 0.1, false});
  const std::string& joint = scene.lead().basis().skeleton.joints[1].name;
  EXPECT_EQ(joint_at(scene, controls, area, 100 + 160, 40 + 180), joint);
  EXPECT_EQ(joint_at(scene, controls, area, 100 + 480, 40 + 180), joint);
  EXPECT_EQ(joint_at(scene, controls, area, 100 + 320, 40 + 180), "") << "between them";
  controls.settings.compare.layout = CompareLayout::wipe;
  EXPECT_EQ(joint_at(scene, controls, area, 100 + 320, 40 + 180), joint);
}

// The limb stands along y, a joint at its foot and one in its middle.
TEST(JointUnderSkin, IsTheOneNearestToWhereTheSkinIsSeen) {
  const TemporaryFolder folder;
  const SmallCharacter small(folder);
  Scene scene(open_test_device());
  scene.add({.basis = small.basis}, {});
  Controls controls;
  const Rectangle area = {100, 40, 640, 360};
  for (const bool orthographic : {false, true}) {
    for (const auto& [height, joint] : {std::pair(0.15, "lower"), {0.4, "upper"}, {0.9, "upper"}}) {
      controls.camera = OrbitCamera({{0, height, 0}, 0.8, 0.3, 0, orthographic});
      EXPECT_EQ(joint_under_skin_at(scene, controls, area, 100 + 320, 40 + 180), joint) << height;
      EXPECT_EQ(joint_under_skin_at(scene, controls, area, 100, 40 + 180), "") << "beside it";
    }
  }
}

TEST(FirstHit, IsThatOfTheNearestTriangleInFrontOfTheEye) {
  const std::vector<float> vertices = {-1, -1, 0, 1, -1, 0, 0, 1, 0, -1, -1, -2, 1, -1, -2, 0, 1, -2};
  const std::vector<std::uint32_t> triangles = {3, 5, 4, 0, 1, 2};  // the far one first, and from behind
  const auto depth = [&](double z) {
    const auto at = first_hit({{0.1, 0, z}, {0, 0, -2}}, vertices, triangles);
    return at ? at->at[2] : 99;
  };
  EXPECT_DOUBLE_EQ(depth(3), 0);
  EXPECT_DOUBLE_EQ(depth(-1), -2);
  EXPECT_EQ(depth(-3), 99);
  EXPECT_FALSE(first_hit({{0.9, 0.9, 3}, {0, 0, -2}}, vertices, triangles));
  EXPECT_TRUE(first_hit({{0.1, 0, -3}, {0, 0, -2}, -1e30}, vertices, triangles)) << "orthographic";
}

}  // namespace
}  // namespace bodyopt::testing
