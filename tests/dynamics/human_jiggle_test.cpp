// The settings that come with the human rig.
#include <gtest/gtest.h>

#include "assets/characters/character.h"
#include "tests/support/paths.h"
#include "tests/support/stand_in_human.h"
#include "trainer/dynamics/jiggle_settings.h"
#include "trainer/simulate/muscle_fibres.h"

namespace bodyopt::trainer {
namespace {

TEST(HumanJiggle, NamesJointsOfTheRigAndHoldsBothSidesAlike) {
  const JiggleSettings settings = read_jiggle(kSourceFolder + "/rigs/human/jiggle.json");
  for (const Character& human : humans("characters/human_average.glb")) {
    const Skeleton& skeleton = human.skeleton;
    std::vector<std::string> held;
    for (const JiggleRegion& region : settings.regions) {
      ASSERT_EQ(region.by, JiggleRegion::By::joint);
      std::size_t found = 0;
      for (const Joint& joint : skeleton.joints) {
        if (!matches_pattern(region.name, joint.name)) continue;
        ++found;
        if (region.amount == 0.0) held.push_back(joint.name);
      }
      EXPECT_GT(found, 0u) << region.name;
    }
    EXPECT_EQ(held, (std::vector<std::string>{"Head", "LeftHand", "LeftHandFinger1", "LeftFingerBase", "LThumb",
                                              "RightHand", "RightHandFinger1", "RightFingerBase", "RThumb",
                                              "LeftToeBase", "RightToeBase"}));
  }
}

}  // namespace
}  // namespace bodyopt::trainer
