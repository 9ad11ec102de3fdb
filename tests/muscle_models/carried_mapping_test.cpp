// Mappings of muscles that were made for one rig, with the joints of another.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/support/paths.h"
#include "tests/support/temporary_folder.h"
#include "trainer/muscle_models/mapping.h"

namespace bodyopt::trainer::muscle_models {
namespace {

Skeleton rig(std::initializer_list<const char*> names) {
  Skeleton skeleton;
  for (const char* name : names) {
    Joint joint;
    joint.name = name;
    joint.parent = static_cast<int>(skeleton.size()) - 1;
    joint.inverse_bind.m[1][3] = static_cast<double>(skeleton.size());
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

// As of characters whose legs have one joint each, at the pelvis.
TEST(CarriedMapping, SaysWhichSegmentsHaveTheirCentresAtOnePlace) {
  const auto path = kSourceFolder + "/rigs/human/gait2392.json";
  Skeleton skeleton = rig({"pelvis", "spine_01", "thigh_r", "calf_r", "foot_r", "thigh_l", "calf_l", "foot_l"});
  EXPECT_TRUE(carried_mapping(path, skeleton).unplaced.empty());
  skeleton.joints[5].inverse_bind = skeleton.joints[2].inverse_bind;
  const std::vector<UnplacedSegment> unplaced = carried_mapping(path, skeleton).unplaced;
  ASSERT_EQ(unplaced.size(), 2u);
  EXPECT_EQ(unplaced[0].segment, "pelvis");
  EXPECT_EQ(unplaced[0].joints, (NamePair{"thigh_r", "thigh_l"}));
  EXPECT_EQ(unplaced[1].segment, "torso");
}

// Of a rig with legs alone, those of the legs; every segment says where its joint is from, and is read again.
TEST(FirstMappings, AreThoseWhoseJointsTheRigHas) {
  const std::vector<CarriedMapping> mappings =
      first_mappings(rig({"pelvis", "spine_01", "thigh_r", "calf_r", "foot_r", "thigh_l", "calf_l", "foot_l"}));
  ASSERT_EQ(mappings.size(), 1u);
  EXPECT_EQ(mappings[0].name, "gait2392.json");
  EXPECT_EQ(mappings[0].unknown.size(), 2u);  // toes
  const Json& segments = mappings[0].json.at("segments");
  EXPECT_EQ(segments[2].at("joint"), "thigh_r");
  EXPECT_EQ(segments[2].at("source"), "the right thigh by its name");
  EXPECT_NE(segments[5].at("source").get<std::string>().find("write it here"), std::string::npos);
  const TemporaryFolder folder;
  write_json(mappings[0].json, folder / mappings[0].name);
  EXPECT_EQ(read_mapping(folder / mappings[0].name).segments.size(), segments.size());

  EXPECT_TRUE(first_mappings(rig({"joint0", "joint1", "joint2"})).empty());
}

}  // namespace
}  // namespace bodyopt::trainer::muscle_models
