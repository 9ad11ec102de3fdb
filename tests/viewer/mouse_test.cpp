#include "proxy_viewer/mouse.h"

#include "tests/support/gpu_fixture.h"
#include "tests/viewer/small_character.h"

namespace bodyopt::testing {
namespace {

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

}  // namespace
}  // namespace bodyopt::testing
