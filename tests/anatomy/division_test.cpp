// Lean tissue divided among muscles: each of its volume, in one piece, with fibres from bone to bone.
#include "trainer/anatomy/division.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/anatomy/lean_box.h"
#include "trainer/anatomy/muscle_paths.h"
#include "trainer/anatomy/muscle_targets.h"

namespace {

using namespace bodyopt;
using namespace bodyopt::trainer;
using Eigen::Index;
using Eigen::Vector3d;

Division divide(const LeanBox& box, const std::vector<Muscle>& muscles) {
  return divide_muscles(box.body, box.grid, box.tissue, muscles);
}

double counted_volume(const LeanBox& box, const Division& division, int muscle) {
  int count = 0;
  for (std::size_t s = 0; s < division.label.size(); ++s) {
    count += division.label[s] == muscle && !division.is_tendon[s] ? 1 : 0;
  }
  return count * box.grid.volume();
}

TEST(MuscleDivision, MusclesShareABoxAsTheirVolumesSay) {
  const LeanBox box({12, 40, 12}, 0.005);
  const Division division = divide(box, {box.upright("one", -0.012, 0, 1.5e-4), box.upright("two", 0.012, 0, 3e-4)});
  ASSERT_EQ(division.muscles.size(), 2u);
  for (const int m : {0, 1}) {
    const Division::OfMuscle& of = division.muscles[static_cast<std::size_t>(m)];
    EXPECT_NEAR(of.target, m == 0 ? 1.5e-4 : 3e-4, 1e-6);
    EXPECT_NEAR(of.volume, of.target, 0.04 * of.target) << m;
    EXPECT_DOUBLE_EQ(of.volume, counted_volume(box, division, m));
    EXPECT_EQ(of.pieces, 1);
    EXPECT_EQ(of.slips, std::vector<int>{m});
  }
}

TEST(MuscleDivision, IsTheSameEveryTime) {
  const LeanBox box({12, 30, 12}, 0.005);
  const std::vector<Muscle> muscles{box.upright("one", -0.01, 0.01, 1e-4), box.upright("two", 0.01, 0, 2e-4)};
  const Division once = divide(box, muscles), again = divide(box, muscles);
  EXPECT_EQ(once.label, again.label);
  EXPECT_EQ(once.is_tendon, again.is_tendon);
  EXPECT_TRUE(once.fibre == again.fibre);
}

TEST(MuscleDivision, PathsThatCoincideAreDrivenApart) {
  const LeanBox box({12, 40, 12}, 0.005);
  const Division division = divide(box, {box.upright("one", 0, 0, 2e-4), box.upright("two", 0.0002, 0.0001, 2e-4)});
  for (const Division::OfMuscle& of : division.muscles) {
    EXPECT_NEAR(of.volume, of.target, 0.08 * of.target);
    EXPECT_EQ(of.pieces, 1);
  }
}

TEST(MuscleDivision, AMuscleThatABoneCrossesStaysInOnePiece) {
  // A wall of bone half way up, open at one side: a thin muscle's path runs through the wall.
  const LeanBox box({16, 40, 8}, 0.005,
                    [](const Vector3d& p) { return std::abs(p.y() - 0.1) < 0.008 && p.x() < 0.025; });
  const Division division = divide(box, {box.upright("thin", -0.03, 0, 4e-5), box.upright("thick", 0.01, 0, 3e-4)});
  for (const Division::OfMuscle& of : division.muscles) EXPECT_EQ(of.pieces, 1);
}

TEST(MuscleDivision, FibresRunAlongACylinderFromOriginToInsertion) {
  const LeanBox box({12, 50, 12}, 0.005, {}, [](const Vector3d& p) { return std::hypot(p.x(), p.z()) < 0.027; });
  const Division division = divide(box, {box.upright("only", 0, 0, 5e-4)});
  int count = 0;
  double sum = 0;
  for (Index s = 0; s < division.fibre.rows(); ++s) {
    const auto at = static_cast<std::size_t>(s);
    if (division.label[at] != 0 || division.is_tendon[at]) {
      EXPECT_TRUE(division.fibre.row(s).isZero());
      continue;
    }
    ++count;
    sum += division.fibre(s, 1);
    EXPECT_NEAR(division.fibre.row(s).norm(), 1, 1e-9);
    EXPECT_GT(division.fibre(s, 1), 0.5) << box.grid.points.row(s);
  }
  EXPECT_GT(sum / count, 0.97) << "a belly tapers towards its ends";
  EXPECT_GT(count, 2000);
}

TEST(MuscleDivision, EndsAreDrawnToTheBonesOfTheirJoints) {
  const LeanBox box({12, 40, 12}, 0.005);
  Muscle high = box.upright("high", 0, 0, 2e-4);  // begins 20 mm above its bone, ends in the middle of nowhere
  high.path.front().position[1] = 0.03;
  high.path.back().position[1] = 0.1;
  const Division::OfMuscle of = divide(box, {high}).muscles.front();
  EXPECT_LT(of.ends_off_bone[0], 0.002);
  EXPECT_EQ(of.end_joint[0], 0);
  EXPECT_NEAR(of.path(0, 1), 0.01, 0.003);
  EXPECT_GT(of.ends_off_bone[1], 0.045) << "too far to be drawn";
  EXPECT_NEAR(of.path(kPathPoints - 1, 1), 0.1, 1e-9);
}

TEST(MuscleDivision, NoMusclesAndNoLeanTissueAreNoMistake) {
  const LeanBox box({8, 10, 8}, 0.005), bone({8, 10, 8}, 0.005, [](const Vector3d&) { return true; });
  EXPECT_TRUE(divide(box, {}).muscles.empty());
  EXPECT_EQ(divide(box, {}).label, std::vector<int>(box.grid.cells.size(), -1));
  const Division none = divide(bone, {bone.upright("lost", 0, 0, 1e-4)});
  ASSERT_EQ(none.muscles.size(), 1u);
  EXPECT_EQ(none.muscles[0].volume, 0);
  EXPECT_TRUE(none.fibre.isZero());
}

TEST(MuscleTargets, ModelsNamesAndAnatomistsNamesFindTheirMuscle) {
  const auto whole = [](const char* name) {
    const WholeMuscle* found = find_whole_muscle(name);
    return found ? found->name : "";
  };
  EXPECT_EQ(whole("glut_max1_r"), "gluteus maximus");
  EXPECT_EQ(whole("glmax3_l"), "gluteus maximus");
  EXPECT_EQ(whole("Left Gluteus Maximus"), "gluteus maximus");
  EXPECT_EQ(whole("pect_l"), "pectineus");
  EXPECT_EQ(whole("PECM2_r"), "pectoralis major");
  EXPECT_EQ(whole("lat_gas_r"), "gastrocnemius lateral head");
  EXPECT_EQ(whole("LAT2"), "latissimus dorsi");
  EXPECT_EQ(whole("SUPSP_l"), "supraspinatus");
  EXPECT_EQ(whole("SUP_l"), "supinator");
  EXPECT_EQ(whole("TRIlong_l"), "triceps");
  EXPECT_EQ(whole("bifemlh_r"), "biceps femoris long head");
  EXPECT_EQ(whole("biceps.R"), "biceps");
  EXPECT_EQ(whole("platysma"), "") << "'pl' stands for palmaris longus, not for what begins with it";
  EXPECT_EQ(whole("tail_lift"), "");
}

TEST(MuscleTargets, SlipsShareOneRegion) {
  const LeanBox box({12, 40, 12}, 0.005);
  const std::vector<HalfMuscle> muscles = muscles_of_half(
      box.body,
      {box.upright("FDS2", 0, 0, 1e-5), box.upright("other", 0.02, 0, 1e-4), box.upright("FDS3", 0.01, 0, 1e-5)});
  ASSERT_EQ(muscles.size(), 2u);
  EXPECT_EQ(muscles[0].muscles, (std::vector<int>{0, 2}));
  EXPECT_NEAR(muscles[0].path(0, 0), 0.005, 1e-9) << "the mean of the slips' paths";
}

TEST(MusclePaths, LeftAndRightOfASymmetricBodyAreAveraged) {
  LeanBox box({12, 40, 12}, 0.005);
  box.body.has_plane = box.body.is_own_mirror = true;
  const std::vector<Muscle> muscles{box.upright("calf_r", -0.012, 0, 1e-5), box.upright("calf_l", 0.010, 0, 1e-5),
                                    box.upright("odd", -0.020, 0, 1e-5), box.upright("twin", 0.022, 0, 1e-5)};
  EXPECT_EQ(mirrored_muscles(box.body, muscles), (std::vector<int>{1, 0, 3, 2})) << "by name, otherwise by place";
  const std::vector<HalfMuscle> half = muscles_of_half(box.body, muscles);
  ASSERT_EQ(half.size(), 2u);
  EXPECT_EQ(half[0].muscles, std::vector<int>{1});
  EXPECT_NEAR(half[0].path(0, 0), 0.011, 1e-12);
  EXPECT_NEAR(half[1].path(0, 0), 0.021, 1e-12);
}

}  // namespace
