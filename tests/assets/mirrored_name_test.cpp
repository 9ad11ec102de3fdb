#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "assets/clips/joint_roles.h"

namespace bodyopt {
namespace {

TEST(MirroredName, IsThatOfTheOtherSide) {
  const std::pair<const char*, const char*> pairs[] = {{"LeftArm", "RightArm"},
                                                       {"mixamorig:LeftHand", "mixamorig:RightHand"},
                                                       {"arm_left_1", "arm_right_1"},
                                                       {"LEFT KNEE", "RIGHT KNEE"},
                                                       {"LThumb", "RThumb"},
                                                       {"ToeL", "ToeR"},
                                                       {"L_Arm", "R_Arm"},
                                                       {"l_leg", "r_leg"},
                                                       {"arm_L_jnt", "arm_R_jnt"},
                                                       {"Bip01 L Arm", "Bip01 R Arm"},
                                                       {"upper.L", "upper.R"},
                                                       {"L_Leg_L", "L_Leg_R"},
                                                       {"clavicle_l", "clavicle_r"}};
  std::vector<std::string> names = {"Legs", "R", "Spine", "Pervis", "Pelvis", "tail", "tair", "LOD", "ROD"};
  for (const auto& [left, right] : pairs) names.insert(names.end(), {left, right});
  for (const auto& [left, right] : pairs) {
    EXPECT_EQ(mirrored_name(left, names), right);
    EXPECT_EQ(mirrored_name(right, names), left);
  }
  // A letter within a word is none of a side.
  for (const char* alone : {"Spine", "Legs", "R", "", "LeftLeg", "Pelvis", "tail"}) {
    EXPECT_EQ(mirrored_name(alone, names), "") << alone;
  }
}

}  // namespace
}  // namespace bodyopt
