#include "assets/clips/joint_roles.h"

#include <gtest/gtest.h>

namespace bodyopt {
namespace {

struct Expected {
  const char* name;
  BodyPart part;
  BodySide side = BodySide::middle;
  std::size_t nested = 0;
};

constexpr BodySide kL = BodySide::left, kR = BodySide::right;

// A chain: each joint is the parent of the next.
void expect_roles(const std::vector<Expected>& expected) {
  std::vector<NamedJoint> joints;
  for (const Expected& joint : expected) joints.push_back({joint.name, static_cast<int>(joints.size()) - 1});
  const auto roles = joint_roles(joints);
  for (std::size_t j = 0; j < expected.size(); ++j) {
    const JointRole wanted{expected[j].part, expected[j].side, expected[j].nested};
    EXPECT_TRUE(roles[j] == wanted) << expected[j].name;
  }
}

void expect_none(const std::vector<std::string>& names) {
  for (const std::string& name : names) {
    EXPECT_FALSE(joint_roles(std::vector<NamedJoint>{{name, -1}})[0]) << name;
  }
}

TEST(JointRoles, OfCmuAsMaxHasIt) {
  expect_roles({{"Hips", BodyPart::hips},
                {"LHipJoint", BodyPart::hip_joint, kL},
                {"LeftUpLeg", BodyPart::thigh, kL},
                {"LeftLeg", BodyPart::shin, kL},
                {"LeftFoot", BodyPart::foot, kL},
                {"LeftToeBase", BodyPart::toe, kL}});
  expect_roles({{"LowerBack", BodyPart::spine},
                {"Spine", BodyPart::spine, BodySide::middle, 1},
                {"Spine1", BodyPart::spine, BodySide::middle, 2},
                {"Neck", BodyPart::neck},
                {"Neck1", BodyPart::neck, BodySide::middle, 1},
                {"Head", BodyPart::head}});
  expect_roles({{"RightShoulder", BodyPart::clavicle, kR},
                {"RightArm", BodyPart::upper_arm, kR},
                {"RightForeArm", BodyPart::forearm, kR},
                {"RightHand", BodyPart::hand, kR},
                {"RightFingerBase", BodyPart::palm, kR},
                {"RightHandIndex1", BodyPart::index, kR},
                {"RThumb", BodyPart::thumb, kR}});
}

TEST(JointRoles, OfCmuAsMotionBuilderAndPoserHaveIt) {
  expect_roles({{"LHipJoint", BodyPart::hip_joint, kL},
                {"LeftHip", BodyPart::thigh, kL},
                {"LeftKnee", BodyPart::shin, kL},
                {"LeftAnkle", BodyPart::foot, kL},
                {"LeftToe", BodyPart::toe, kL},
                {"lowerback", BodyPart::spine},
                {"Chest", BodyPart::spine, BodySide::middle, 1},
                {"Chest2", BodyPart::spine, BodySide::middle, 2},
                {"lowerneck", BodyPart::neck},
                {"Neck", BodyPart::neck, BodySide::middle, 1},
                {"LeftCollar", BodyPart::clavicle, kL},
                {"LeftShoulder", BodyPart::upper_arm, kL},
                {"LeftElbow", BodyPart::forearm, kL},
                {"LeftWrist", BodyPart::hand, kL},
                {"lhand", BodyPart::palm, kL},
                {"LFingers", BodyPart::index, kL}});
  expect_roles({{"hip", BodyPart::hips},
                {"abdomen", BodyPart::spine},
                {"chest", BodyPart::spine, BodySide::middle, 1},
                {"rCollar", BodyPart::clavicle, kR},
                {"rShldr", BodyPart::upper_arm, kR},
                {"rForeArm", BodyPart::forearm, kR},
                {"rHand", BodyPart::hand, kR},
                {"rMid1", BodyPart::middle, kR},
                {"lThigh", BodyPart::thigh, kL},
                {"lShin", BodyPart::shin, kL}});
}

TEST(JointRoles, OfMixamoHumanIkAndUnreal) {
  expect_roles({{"mixamorig:Hips", BodyPart::hips},
                {"mixamorig:Spine", BodyPart::spine},
                {"mixamorig:LeftShoulder", BodyPart::clavicle, kL},
                {"mixamorig:LeftArm", BodyPart::upper_arm, kL},
                {"mixamorig:LeftHandMiddle1", BodyPart::middle, kL},
                {"mixamorig:LeftHandMiddle2", BodyPart::middle, kL, 1}});
  expect_roles({{"mixamorigHips", BodyPart::hips}, {"mixamorig1_LeftUpLeg", BodyPart::thigh, kL}});
  expect_roles({{"Character1_Hips", BodyPart::hips},
                {"Character1_Spine", BodyPart::spine},
                {"rig|body:Character1_RightToeBase", BodyPart::toe, kR}});
  expect_roles({{"pelvis", BodyPart::hips},
                {"spine_01", BodyPart::spine},
                {"spine_02", BodyPart::spine, BodySide::middle, 1},
                {"clavicle_l", BodyPart::clavicle, kL},
                {"upperarm_l", BodyPart::upper_arm, kL},
                {"lowerarm_l", BodyPart::forearm, kL},
                {"hand_l", BodyPart::hand, kL},
                {"index_01_l", BodyPart::index, kL},
                {"thigh_r", BodyPart::thigh, kR},
                {"calf_r", BodyPart::shin, kR},
                {"foot_r", BodyPart::foot, kR},
                {"ball_r", BodyPart::toe, kR},
                {"neck_01", BodyPart::neck}});
}

TEST(JointRoles, OfVroidSmplAndBiovision) {
  expect_roles({{"J_Bip_C_Hips", BodyPart::hips},
                {"J_Bip_C_Spine", BodyPart::spine},
                {"J_Bip_C_UpperChest", BodyPart::spine, BodySide::middle, 1},
                {"J_Bip_C_Neck", BodyPart::neck},
                {"J_Bip_C_Head", BodyPart::head},
                {"J_Bip_L_UpperLeg", BodyPart::thigh, kL},
                {"J_Bip_L_ToeBase", BodyPart::toe, kL}});
  expect_roles({{"Pelvis", BodyPart::hips},
                {"L_Hip", BodyPart::thigh, kL},
                {"L_Knee", BodyPart::shin, kL},
                {"L_Ankle", BodyPart::foot, kL},
                {"L_Foot", BodyPart::toe, kL},
                {"L_Collar", BodyPart::clavicle, kL},
                {"L_Shoulder", BodyPart::upper_arm, kL},
                {"L_Elbow", BodyPart::forearm, kL},
                {"L_Wrist", BodyPart::hand, kL}});
  expect_roles({{"Hips", BodyPart::hips},
                {"ToSpine", BodyPart::spine},
                {"Chest", BodyPart::spine, BodySide::middle, 1},
                {"LeftHip", BodyPart::thigh, kL},
                {"LeftAnkle", BodyPart::foot, kL},
                {"LeftToe", BodyPart::toe, kL}});
}

// Whatever a program puts before or behind all names.
TEST(JointRoles, BesideAPrefixOrEndingThatJointsShare) {
  const std::vector<Expected> joints = {{"Pelvis", BodyPart::hips},
                                        {"Spine", BodyPart::spine},
                                        {"Spine1", BodyPart::spine, BodySide::middle, 1},
                                        {"Neck", BodyPart::neck},
                                        {"Head", BodyPart::head},
                                        {"L Clavicle", BodyPart::clavicle, kL},
                                        {"L UpperArm", BodyPart::upper_arm, kL},
                                        {"L Forearm", BodyPart::forearm, kL},
                                        {"L Hand", BodyPart::hand, kL},
                                        {"R Thigh", BodyPart::thigh, kR},
                                        {"R Calf", BodyPart::shin, kR},
                                        {"R Foot", BodyPart::foot, kR}};
  for (const auto& [prefix, ending] : {std::pair<std::string, std::string>{"Bip01 ", ""},
                                       {"Bip001 ", ""},
                                       {"CC_Base_", ""},
                                       {"b_", ""},
                                       {"x:Hero-", ""},
                                       {"joint", ""},
                                       {"", "_jnt"},
                                       {"rig:", " Bind"},
                                       {"DEF-", "_x"}}) {
    std::vector<std::string> names;
    for (const Expected& joint : joints) names.push_back(prefix + joint.name + ending);
    std::vector<NamedJoint> named{{"Bip01", -1}, {"Camera", -1}};
    for (const std::string& name : names) named.push_back({name, static_cast<int>(named.size()) - 1});
    const auto roles = joint_roles(named);
    for (std::size_t j = 0; j < joints.size(); ++j) {
      EXPECT_TRUE(roles[j + 2] == (JointRole{joints[j].part, joints[j].side, joints[j].nested})) << names[j];
    }
  }
}

// What they share may be what they are.
TEST(JointRoles, ASharedPartOrSideIsNoPrefix) {
  expect_roles({{"LeftShoulder", BodyPart::clavicle, kL},
                {"LeftArm", BodyPart::upper_arm, kL},
                {"LeftForeArm", BodyPart::forearm, kL},
                {"LeftHand", BodyPart::hand, kL}});
  expect_roles({{"spine_01", BodyPart::spine},
                {"spine_02", BodyPart::spine, BodySide::middle, 1},
                {"spine_03", BodyPart::spine, BodySide::middle, 2},
                {"spine_04", BodyPart::spine, BodySide::middle, 3}});
}

TEST(JointRoles, SidesStandAtEitherEndInAnyDress) {
  for (const char* name : {"LeftUpperArm", "left_upper_arm", "UpperArm.L", "upperarm-left", "L_UpperArm", "lUpperArm",
                           "leftupperarm", "UPPERARM_L", "upper arm l", "UpperArm01.L"}) {
    expect_roles({{name, BodyPart::upper_arm, kL}});
  }
}

// What a name means depends on the names beside it.
TEST(JointRoles, DependOnTheWholeSkeleton) {
  expect_roles({{"LeftShoulder", BodyPart::clavicle, kL}, {"LeftArm", BodyPart::upper_arm, kL}});
  expect_roles({{"LeftShoulder", BodyPart::upper_arm, kL}, {"LeftElbow", BodyPart::forearm, kL}});
  expect_roles({{"RightShoulder", BodyPart::upper_arm, kR}, {"LeftArm", BodyPart::upper_arm, kL}});  // of its own side
  expect_roles({{"leg.L", BodyPart::thigh, kL}, {"shin.L", BodyPart::shin, kL}});
  expect_roles({{"thigh.L", BodyPart::thigh, kL}, {"leg.L", BodyPart::shin, kL}});
  expect_roles({{"root", BodyPart::hips}, {"spine05", BodyPart::spine}, {"pelvis.L", BodyPart::hip_joint, kL}});
  expect_none({"Armature", "upperarm_twist_01_l", "HeadTop_End", "LeftToe_End", "toe1-1.L", "finger2-1.L",
               "FrontUpLeg.R", "Shoulders", "b_Hip_01", "ik_hand_l", "", "L", "left", "1", "LeftArmRoll", "Arm",
               "\xff\xfe"});
  const auto roles = joint_roles(std::vector<NamedJoint>{{"root", -1}, {"pelvis", 0}});
  EXPECT_FALSE(roles[0]);
  EXPECT_EQ(roles[1]->part, BodyPart::hips);
}

TEST(JointRoles, TheFirstOfTwoHasTheRole) {
  const auto roles = joint_roles(std::vector<NamedJoint>{{"Hips", -1}, {"LeftArm", 0}, {"l_arm", 0}, {"Left Arm", 1}});
  EXPECT_TRUE(roles[1]);
  EXPECT_FALSE(roles[2]);
  EXPECT_EQ(roles[3]->nested, 1u);
}

}  // namespace
}  // namespace bodyopt
