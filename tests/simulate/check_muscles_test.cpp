#include "trainer/simulate/check_muscles.h"

#include <gtest/gtest.h>

#include "runtime/core/error.h"
#include "tests/simulate/limb.h"

namespace bodyopt::trainer {
namespace {

Muscle thread(const std::string& name) {
  Muscle muscle = make_flexor();
  muscle.name = name;
  muscle.radius = 1e-4;
  return muscle;
}

std::string said(const std::vector<Muscle>& muscles) {
  const Character limb = make_limb();
  return check_muscles(limb, muscles, own_body(limb, muscles, 0.05, kLimbAnatomy));
}

TEST(CheckMuscles, ThoseWithoutRoomAreCountedAndNamed) {
  EXPECT_EQ(said({}), "");
  EXPECT_EQ(said({make_flexor()}), "");
  EXPECT_EQ(said({make_flexor(), thread("a")}), "1 muscle finds no room in the body and pulls nothing: 'a'");
  EXPECT_EQ(said({make_flexor(), thread("a"), thread("b")}),
            "2 muscles find no room in the body and pull nothing: 'a', 'b'");
}

// Each of them has to be mended.
TEST(CheckMuscles, AllOfThemAreNamed) {
  std::vector<Muscle> muscles{make_flexor()};
  for (int k = 0; k < 20; ++k) muscles.push_back(thread("t" + std::to_string(k)));
  const std::string text = said(muscles);
  EXPECT_NE(text.find("20 muscles"), std::string::npos) << text;
  EXPECT_TRUE(text.ends_with("'t18', 't19'")) << text;
}

TEST(CheckMuscles, PathsOutsideTheSkinAreRefusedHoweverThick) {
  Muscle stray = make_flexor();
  stray.name = "stray";
  stray.radius = 0.4;
  for (MusclePoint& point : stray.path) point.position[1] += 0.3;
  const Character limb = make_limb();
  const std::vector<Muscle> muscles{stray};
  const QuasiStaticBody body = own_body(limb, muscles, 0.05, kLimbAnatomy);
  try {
    check_muscles(limb, muscles, body);
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::mismatch);
    EXPECT_NE(std::string(error.what()).find("'stray'"), std::string::npos) << error.what();
  }
}

TEST(CheckMuscles, EndsMayStickOut) {
  Muscle across = make_flexor();
  across.path = {{0, {0.1, 0.05, 0}}, {1, {0.4, -0.05, 0}}};
  EXPECT_EQ(said({across}), "");
}

}  // namespace
}  // namespace bodyopt::trainer
