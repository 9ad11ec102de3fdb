// Kinds of bodies and the joints that carry bone: of characters that other programs wrote, and of bodies of tubes.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/anatomy/tube_body.h"
#include "tests/support/capsule_limb.h"
#include "tests/support/shared_data.h"
#include "tests/support/stand_in_human.h"
#include "trainer/anatomy/body_kind.h"
#include "trainer/anatomy/half_body.h"

namespace {

using namespace bodyopt;
using namespace bodyopt::trainer;

std::optional<Character> shared_character(const std::string& file, double unit = 1) {
  const auto path = shared_data("characters/" + file);
  if (!path) return std::nullopt;
  return read_character(*path, unit);
}

std::string kind_of(const Character& character) { return name_of(recognise_kind(character).kind); }

// Names of the joints that carry bone.
std::vector<std::string> with_bone(const Character& character) {
  const std::vector<bool> carries = carries_bone(character);
  std::vector<std::string> names;
  for (std::size_t j = 0; j < carries.size(); ++j) {
    if (carries[j]) names.push_back(character.skeleton.joints[j].name);
  }
  return names;
}

bool has(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

TEST(BodyKind, NamesAreReadAsTheyAreWritten) {
  for (const BodyKind kind : {BodyKind::biped, BodyKind::quadruped, BodyKind::bird, BodyKind::snake, BodyKind::fish,
                              BodyKind::many_legs, BodyKind::limb})
    EXPECT_EQ(body_kind_of(name_of(kind)), kind);
  EXPECT_FALSE(body_kind_of("horse"));
}

TEST(BodyKind, IsToldByShapeWhereNamesTellNothing) {
  EXPECT_EQ(kind_of(snake_body()), "snake");
  EXPECT_EQ(kind_of(fish_body()), "fish");
  EXPECT_EQ(kind_of(spider_body()), "many_legs");
  EXPECT_EQ(kind_of(winged_or_four_legged(true)), "bird");
  EXPECT_EQ(kind_of(winged_or_four_legged(false)), "quadruped");
  EXPECT_EQ(kind_of(limb_character()), "limb");
  EXPECT_EQ(kind_of(stand_in_human()), "biped");
}

TEST(BodyKind, EveryKindIsExplained) {
  for (const Character& character : {snake_body(), fish_body(), spider_body(), limb_character(), stand_in_human()})
    EXPECT_FALSE(recognise_kind(character).why.empty());
}

TEST(BodyKind, OfCharactersThatOthersMade) {
  const std::vector<std::tuple<std::string, double, std::string>> characters{{"fox.glb", 0.01, "quadruped"},
                                                                             {"mesh2motion_horse.glb", 1, "quadruped"},
                                                                             {"quaternius_horse.glb", 0.3, "quadruped"},
                                                                             {"quaternius_trex.glb", 0.4, "biped"},
                                                                             {"cesium_man.glb", 1, "biped"},
                                                                             {"greenman.glb", 1, "biped"},
                                                                             {"quaternius_man.glb", 0.33, "biped"},
                                                                             {"human_163_joints.glb", 1, "biped"},
                                                                             {"human_muscular.glb", 1, "biped"},
                                                                             {"simple_skin.gltf", 1, "limb"}};
  for (const auto& [file, unit, kind] : characters) {
    const auto character = shared_character(file, unit);
    if (!character) GTEST_SKIP() << kNeedsOtherWriters;
    EXPECT_EQ(kind_of(*character), kind) << file << ": " << recognise_kind(*character).why;
  }
}

TEST(BodyKind, ArmOfTheDemoIsALimb) {
  EXPECT_EQ(kind_of(read_character(kSourceFolder + std::string("/rigs/arm/arm.glb"))), "limb");
}

TEST(BodyFrame, TellsWhichWayABodyLooks) {
  const Character human = stand_in_human();
  EXPECT_EQ(body_frame(human), Eigen::Matrix3d::Identity());
  Eigen::Matrix3d quarter;  // looks along x
  quarter << 0, 0, 1, 0, 1, 0, -1, 0, 0;
  EXPECT_EQ(body_frame(turned(human, quarter)), quarter.transpose());
}

TEST(CarriesBone, NotControlsNorEndsNorEars) {
  const auto horse = shared_character("mesh2motion_horse.glb");
  const auto low_horse = shared_character("quaternius_horse.glb", 0.3);
  if (!horse || !low_horse) GTEST_SKIP() << kNeedsOtherWriters;
  const std::vector<std::string> bones = with_bone(*horse), low_bones = with_bone(*low_horse);
  for (const char* name : {"front_leg_upper_l", "back_leg_ankle_r", "spine_3", "spine_6"})
    EXPECT_TRUE(has(bones, name)) << name;
  for (const char* name : {"root", "ear_1_l", "ear_2_r", "head_leaf", "tail_leaf", "ribcage_leaf"})
    EXPECT_FALSE(has(bones, name)) << name;
  for (const char* name : {"FrontLowLeg.L", "BackLowLeg.R", "Neck", "Tail2"}) EXPECT_TRUE(has(low_bones, name)) << name;
  // Feet for inverse kinematics hang at the root, their bone at the leg.
  for (const char* name : {"root", "FrontFoot.R", "BackFoot.L", "Head_end", "FrontLowLeg.L_end"})
    EXPECT_FALSE(has(low_bones, name)) << name;
}

}  // namespace
