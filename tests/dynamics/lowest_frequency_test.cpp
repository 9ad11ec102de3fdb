#include <gtest/gtest.h>

#include <numbers>

#include "trainer/dynamics/jiggle.h"

namespace bodyopt::trainer {
namespace {

double squared_angular(double hertz) { return std::pow(2 * std::numbers::pi * hertz, 2); }

// One stiff tet on springs by which it swings as a whole at some frequency.
struct OneTet {
  explicit OneTet(double hertz) {
    mesh.nodes.resize(4, 3);
    mesh.nodes << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1;
    mesh.tets.resize(1, 4);
    mesh.tets << 0, 1, 2, 3;
    skeleton.joints.resize(1);
    skeleton.joints[0].name = "tail";
    anatomy.joint_share = NodeWeights::Ones(4, 1);
    system.materials = {{1e9, 1e9}};
    system.mass = lumped_mass(mesh, 1000);
    system.springs = (squared_angular(hertz) * system.mass).asDiagonal();
  }
  void hold(double lowest, double softness) {
    hold_slow_parts(lowest, Eigen::VectorXd::Constant(4, softness), skeleton, mesh, anatomy, system, notes);
  }
  double hertz() const { return std::sqrt(system.springs.coeff(2, 2) / system.mass[2]) / (2 * std::numbers::pi); }

  TetMesh mesh;
  Skeleton skeleton;
  JiggleAnatomy anatomy;
  JiggleSystem system;
  std::vector<std::string> notes;
};

TEST(LowestFrequency, SlowPartsSwingAtItAndAreNamed) {
  OneTet slow(1.5);
  slow.hold(4, 1);
  EXPECT_NEAR(slow.hertz(), 4, 1e-3);
  ASSERT_EQ(slow.notes.size(), 1u);
  EXPECT_NE(slow.notes[0].find("'tail' would swing at 1.5 Hz"), std::string::npos) << slow.notes[0];
}

TEST(LowestFrequency, GoesDownWithTheRootOfTheSoftness) {
  OneTet soft(1.5);
  soft.hold(4, 4);
  EXPECT_NEAR(soft.hertz(), 2, 1e-3);
}

TEST(LowestFrequency, ChangesNoBitOfWhatIsFasterNorWithoutOne) {
  for (const double lowest : {4.0, 0.0}) {
    OneTet part(lowest == 0 ? 0.5 : 4.1);
    const double before = part.system.springs.coeff(2, 2);
    part.hold(lowest, 1);
    EXPECT_EQ(part.system.springs.coeff(2, 2), before);
    EXPECT_TRUE(part.notes.empty());
  }
}

}  // namespace
}  // namespace bodyopt::trainer
