#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "assets/characters/character.h"
#include "assets/characters/muscles.h"
#include "runtime/core/json.h"
#include "tests/support/png_file.h"
#include "tests/support/read_bytes.h"
#include "tests/support/run_verb.h"
#include "tests/support/shared_data.h"
#include "tests/support/temporary_folder.h"
#include "trainer/builtin/arm.h"

namespace bodyopt {
namespace {

using namespace trainer;

std::vector<std::string> keys_of(const Json& json) {
  std::vector<std::string> keys;
  for (const auto& [key, value] : json.items()) keys.push_back(key);
  return keys;
}

// Of every part the shares of all tissues are the whole, and the parts make up the body.
void expect_whole(const Json& told) {
  EXPECT_EQ(keys_of(told),
            (std::vector<std::string>{"schema", "kind", "kind_because", "parts", "muscles", "limb_factors",
                                      "mirror_difference_percent", "seconds", "warnings"}));
  EXPECT_EQ(told["schema"], "bodyopt-anatomy-1");
  EXPECT_FALSE(told["kind_because"].get<std::string>().empty());
  double volume = 0;
  for (const auto& [name, part] : told["parts"].items()) {
    EXPECT_EQ(keys_of(part), (std::vector<std::string>{"volume_cm3", "bone_percent", "fat_percent", "cavity_percent",
                                                       "muscle_percent", "other_lean_percent"}));
    double percent = 0;
    for (const auto& [key, value] : part.items()) percent += key == "volume_cm3" ? 0 : value.get<double>();
    EXPECT_NEAR(percent, 100, 1e-6) << name;
    volume += name == "body" ? 0 : part["volume_cm3"].get<double>();
  }
  EXPECT_NEAR(volume, told["parts"]["body"]["volume_cm3"].get<double>(), 1e-6 * volume);
}

TEST(Anatomy, OfTheBuiltinArm) {
  const TemporaryFolder folder;
  const BuiltinArm arm = build_arm();
  const std::string character = (folder / "arm.glb").string(), muscles = (folder / "muscles.json").string();
  const std::string json = (folder / "arm.json").string(), picture = (folder / "arm.png").string();
  write_character(arm.character, character);
  write_muscles(arm.muscles, arm.character.skeleton, muscles);
  const ProgramResult result =
      run_verb("anatomy " + character + " --muscles " + muscles + " --json " + json + " --picture " + picture);
  ASSERT_EQ(result.exit_code, 0) << result.output;
  const Json told = Json::parse(testing::read_bytes(json));
  expect_whole(told);
  ASSERT_EQ(told["muscles"].size(), arm.muscles.size());
  double of_muscles = 0;
  for (std::size_t m = 0; m < arm.muscles.size(); ++m) {
    const Json& muscle = told["muscles"][m];
    EXPECT_EQ(muscle["name"], arm.muscles[m].name);
    EXPECT_EQ(muscle["ends_off_bone_mm"].size(), 2u);
    EXPECT_GE(muscle["pieces"], 1);
    of_muscles += muscle["volume_cm3"].get<double>();
  }
  const Json& body = told["parts"]["body"];
  EXPECT_NEAR(of_muscles, 0.01 * body["muscle_percent"].get<double>() * body["volume_cm3"].get<double>(),
              1e-6 * of_muscles);
  EXPECT_GT(testing::read_png(picture).width, 400u);
  EXPECT_NE(result.output.find("wrote " + picture + ": 1 "), std::string::npos) << result.output;
}

TEST(Anatomy, RefusesWhatItCannotBeAsked) {
  const TemporaryFolder folder;
  const std::string character = (folder / "arm.glb").string();
  write_character(build_arm().character, character);
  const ProgramResult kind = run_verb("anatomy " + character + " --kind octopus");
  EXPECT_EQ(kind.exit_code, 64);
  EXPECT_NE(kind.output.find("quadruped"), std::string::npos) << kind.output;
  EXPECT_EQ(run_verb("anatomy " + character + " --body-fat 0.9").exit_code, 64);
  EXPECT_EQ(run_verb("anatomy " + character + " --cell 0").exit_code, 64);
  const ProgramResult fine = run_verb("anatomy " + character + " --cell 0.01");
  EXPECT_EQ(fine.exit_code, 64);
  EXPECT_NE(fine.output.find("samples"), std::string::npos) << fine.output;
  EXPECT_EQ(run_verb("anatomy " + character + " --picture /nonexistent/x.png").exit_code, 4);
}

// Its sides differ by more than a hundred percent, which is told in digits alone.
TEST(Anatomy, OfABodyThatIsNotItsMirrorImage) {
  const auto horse = shared_data("characters/quaternius_horse.glb");
  if (!horse) GTEST_SKIP() << kNeedsOtherWriters;
  const ProgramResult result = run_verb("anatomy " + horse->string() + " --unit 0.3 --cell 20");
  ASSERT_EQ(result.exit_code, 0) << result.output;
  EXPECT_NE(result.output.find("left and right differ by 1"), std::string::npos) << result.output;
  EXPECT_EQ(result.output.find("e+"), std::string::npos) << result.output;
}

TEST(Anatomy, OfASkinThatPassesThroughItself) {
  const auto trex = shared_data("characters/quaternius_trex.glb");
  if (!trex) GTEST_SKIP() << kNeedsOtherWriters;
  const ProgramResult result = run_verb("anatomy " + trex->string() + " --unit 0.4 --cell 100");
  ASSERT_EQ(result.exit_code, 0) << result.output;
  EXPECT_NE(result.output.find("passes through itself at 2 pairs of triangles, most at 'Neck'"), std::string::npos)
      << result.output;
}

TEST(Anatomy, HumansAreTheirOwnMirrorImages) {
  const auto human = shared_data("characters/human_muscular.glb");
  if (!human) GTEST_SKIP() << kNeedsRealBodies;
  const TemporaryFolder folder;
  const std::string json = (folder / "human.json").string();
  const ProgramResult result = run_verb("anatomy " + human->string() + " --cell 8 --json " + json);
  ASSERT_EQ(result.exit_code, 0) << result.output;
  const Json told = Json::parse(testing::read_bytes(json));
  expect_whole(told);
  EXPECT_EQ(told["kind"], "biped");
  EXPECT_LT(told["mirror_difference_percent"], 0.01);
  for (const char* part : {"thigh", "upper_arm", "forearm", "calf", "trunk", "hip", "head", "neck", "foot", "hand"}) {
    EXPECT_TRUE(told["parts"].contains(part)) << part;
  }
  // Another body fat is in the numbers.
  ASSERT_EQ(run_verb("anatomy " + human->string() + " --cell 8 --body-fat 0.3 --json " + json).exit_code, 0);
  const Json fatter = Json::parse(testing::read_bytes(json));
  EXPECT_GT(fatter["parts"]["body"]["fat_percent"].get<double>(),
            told["parts"]["body"]["fat_percent"].get<double>() + 5);
}

}  // namespace
}  // namespace bodyopt
