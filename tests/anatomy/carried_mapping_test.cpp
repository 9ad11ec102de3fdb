// Mappings of muscles that were made for one rig, with the joints of another.
#include "trainer/anatomy/carried_mapping.h"

#include <gtest/gtest.h>

#include "tests/support/paths.h"
#include "tests/support/temporary_folder.h"
#include "trainer/anatomy/mapping.h"

namespace bodyopt::anatomy {
namespace {

Skeleton rig(std::initializer_list<const char*> names) {
  Skeleton skeleton;
  for (const char* name : names) {
    Joint joint;
    joint.name = name;
    joint.parent = static_cast<int>(skeleton.size()) - 1;
    skeleton.joints.push_back(joint);
  }
  return skeleton;
}

TEST(CarriedMapping, NamesTheJointsThatDoTheSame) {
  const auto path = kSourceFolder + "/rigs/human/gait2392.json";
  const CarriedMapping mapping =
      carried_mapping(path, rig({"pelvis", "spine_01", "thigh_r", "calf_r", "foot_r", "thigh_l", "calf_l", "foot_l"}));
  const Json& segments = mapping.json.at("segments");
  EXPECT_EQ(segments[0].at("joint"), "pelvis");
  EXPECT_EQ(segments[0].at("centres")[1][1], "thigh_l");
  EXPECT_EQ(segments[3].at("joint"), "calf_r");
  EXPECT_EQ(segments[3].at("centres")[0][0], "tibia_r");  // the model's own names stay
  EXPECT_EQ(mapping.unknown, (std::vector<std::string>{"LeftToeBase", "RightToeBase"}));
  EXPECT_EQ(segments[5].at("joint"), "RightToeBase");
}

TEST(CarriedMapping, MirrorsByTheNewNamesAndIsReadAgain) {
  const TemporaryFolder folder;
  const CarriedMapping mapping = carried_mapping(kSourceFolder + "/rigs/human/myo_arm.json",
                                                 rig({"spine_01", "clavicle_r", "upperarm_r", "lowerarm_r", "hand_r",
                                                      "clavicle_l", "upperarm_l", "lowerarm_l", "hand_l"}));
  write_json(mapping.json, folder / "arm.json");
  const Mapping read = read_mapping(folder / "arm.json");
  EXPECT_EQ(read.mirrored_joint("lowerarm_r"), "lowerarm_l");
  EXPECT_EQ(read.mirrored_joint("hand_r"), "hand_l");
}

}  // namespace
}  // namespace bodyopt::anatomy
