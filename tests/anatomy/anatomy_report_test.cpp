// What the report says of a body that is not as it should be.
#include "trainer/anatomy/anatomy_report.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/anatomy/egg_human.h"
#include "tests/support/stand_in_human.h"

namespace {

using namespace bodyopt;
using namespace bodyopt::trainer;

AnatomyReport report_of(const Character& character, const std::vector<Muscle>& muscles, AnatomyOptions options = {}) {
  options.cell = 0.012;
  return report_anatomy(character, muscles, AnatomyField(character, muscles, options));
}

bool warns_of(const AnatomyReport& report, const std::string& words) {
  return std::ranges::any_of(report.warnings, [&](const auto& each) { return each.find(words) != each.npos; });
}

// The same on both sides of an egg, but moved along x.
std::vector<Muscle> pair_of_muscles(const Character& egg, double moved) {
  std::vector<Muscle> muscles;
  for (const bool is_left : {true, false}) {
    const auto joint = [&](const std::string& name) {
      return static_cast<std::uint32_t>(egg.skeleton.find((is_left ? "Left" : "Right") + name));
    };
    const double side = is_left ? 1 : -1;
    Muscle muscle;
    muscle.name = is_left ? "own_l" : "own_r";
    muscle.radius = 0.02;
    muscle.path = {{joint("UpLeg"), {moved + 0.1 * side, 0.9, 0.05}}, {joint("Leg"), {moved + 0.1 * side, 0.5, 0.05}}};
    muscles.push_back(muscle);
  }
  return muscles;
}

TEST(AnatomyReport, WarnsOfMusclesThatTheMeanOfBothSidesHides) {
  const Character egg = egg_human();
  const std::string words = "mirror image of the other side's";
  EXPECT_FALSE(warns_of(report_of(egg, pair_of_muscles(egg, 0)), words));
  EXPECT_TRUE(warns_of(report_of(egg, pair_of_muscles(egg, 1)), words));
}

TEST(AnatomyReport, SaysWhichWayBodyFatDoesNotFit) {
  const Character human = stand_in_human();
  EXPECT_TRUE(warns_of(report_of(human, {}, {.body_fat = 0.02}), "more than the 2 % asked for"));
  const std::string words = "leave little room for muscles";
  EXPECT_FALSE(warns_of(report_of(human, {}), words));
  EXPECT_TRUE(warns_of(report_of(human, {}, {.body_fat = 0.6}), words));
}

TEST(AnatomyReport, MirrorDifferenceIsOfTissuesToo) {
  AnatomyOptions options;
  options.corrections.bones["LeftUpLeg"].thicker = 0.01;
  const Character human = stand_in_human();
  EXPECT_GT(*report_of(human, {}, options).mirror_difference, *report_of(human, {}).mirror_difference + 0.2);
}

TEST(SkinCrossing, IsToldWithItsPlace) {
  Character human = stand_in_human();
  EXPECT_EQ(skin_crossing(human), "");
  const auto leg = static_cast<std::uint32_t>(human.skeleton.find("LeftLeg"));
  for (std::size_t v = 0; v < human.weights.size(); ++v) {
    if (human.weights[v].front().joint == leg) human.vertices(static_cast<Eigen::Index>(v), 0) -= 0.2;
  }
  EXPECT_NE(skin_crossing(human).find("Leg'"), std::string::npos) << skin_crossing(human);
}

}  // namespace
