#include "trainer/simulate/check_muscles.h"

#include <gtest/gtest.h>

#include "runtime/core/error.h"
#include "tests/simulate/limb.h"
#include "trainer/tets/lattice_cage.h"

namespace bodyopt {
namespace {

Muscle thread(const std::string& name) {
  Muscle muscle = make_flexor();
  muscle.name = name;
  muscle.radius = 1e-4;
  return muscle;
}

std::string said(const std::vector<Muscle>& muscles) {
  const Character limb = make_limb();
  return check_muscles(limb, muscles, QuasiStaticBody(limb, muscles, fill_skin(limb, 0.05)));
}

TEST(CheckMuscles, ThoseThinnerThanATetAreCountedAndNamed) {
  EXPECT_EQ(said({}), "");
  EXPECT_EQ(said({make_flexor()}), "");
  EXPECT_EQ(
      said({make_flexor(), thread("a")}),
      "1 muscle is thinner than the tetrahedra and pulls in one of them alone: 'a'; a smaller --tet-size may help");
  EXPECT_EQ(said({thread("a"), make_flexor(), thread("b")}),
            "2 muscles are thinner than the tetrahedra and pull in one of them alone: 'a', 'b'; a smaller --tet-size "
            "may help");
}

// Each of them has to be mended.
TEST(CheckMuscles, AllOfThemAreNamed) {
  std::vector<Muscle> muscles{make_flexor()};
  for (int k = 0; k < 20; ++k) muscles.push_back(thread("t" + std::to_string(k)));
  const std::string text = said(muscles);
  EXPECT_NE(text.find("20 muscles"), std::string::npos) << text;
  EXPECT_NE(text.find("'t18', 't19'; "), std::string::npos) << text;
}

// Its tets do not come from --tet-size.
TEST(CheckMuscles, NoTetSizeIsAdvisedInACage) {
  const Character limb = make_limb();
  const std::vector<Muscle> muscles{make_flexor(), thread("a")};
  const QuasiStaticBody body(limb, muscles, lattice_cage(limb.vertices, limb.triangles, limb.weights, 300));
  EXPECT_EQ(check_muscles(limb, muscles, body),
            "1 muscle is thinner than the tetrahedra and pulls in one of them alone: 'a'");
}

TEST(CheckMuscles, PathsOutsideTheSkinAreRefusedHoweverThick) {
  Muscle stray = make_flexor();
  stray.name = "stray";
  stray.radius = 0.4;
  for (MusclePoint& point : stray.path) point.position[1] += 0.3;
  const Character limb = make_limb();
  const std::vector<Muscle> muscles{stray};
  const QuasiStaticBody body(limb, muscles, fill_skin(limb, 0.05));
  ASSERT_FALSE(body.fibres().empty());
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
}  // namespace bodyopt
