// Soft parts under another gravity.
#include <gtest/gtest.h>

#include <fstream>
#include <numbers>

#include "runtime/deformer/deformer.h"
#include "runtime/host/device_choice.h"
#include "runtime/modifiers/drive_modifiers.h"
#include "tests/support/error_kind.h"
#include "tests/support/limb_dynamics.h"
#include "tests/support/temporary_folder.h"
#include "trainer/modifiers/bake_stack.h"

namespace bodyopt::testing {
namespace sag_test {

using namespace trainer;

constexpr double kGravity = 9.81;

class Sag : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    const TemporaryFolder folder;
    save_dynamics(limb_model().dynamics, folder / "limb.dynamics.safetensors");
    std::ofstream(folder / "stack.json") << R"({"schema": "bodyopt-modifiers-1", "modifiers": [
      {"name": "flesh", "type": "sag", "dynamics": "limb.dynamics.safetensors"}]})";
    basis_ = new Basis(limb_model().basis);
    std::vector<std::string> notes;
    basis_->modifiers = bake_stack(folder / "stack.json", limb_model().basis, notes);
    validate(*basis_, "the test's basis");
  }
  static void TearDownTestSuite() { delete basis_; }

  static Pose driven(Pose pose, const std::map<std::string, float>& constants) {
    Basis basis = *basis_;
    basis.modifiers.stack[0].constants = constants;
    drive_modifiers(basis, {}, 24, {&pose, 1});
    return pose;
  }

  static std::vector<float> shown(const Basis& basis, const Pose& pose) {
    DeviceChoice cpu;
    cpu.name = "cpu";
    return Deformer(basis, cpu).evaluate({&pose, 1}).positions;
  }

  static inline Basis* basis_ = nullptr;
};

TEST_F(Sag, TheUsualGravityChangesNoBit) {
  const Pose pose = limb_pose({.turn = 0.4, .elbow = 1});
  EXPECT_EQ(shown(*basis_, driven(pose, {})), shown(limb_model().basis, pose));
}

// What the dynamics come to rest at, where gravity is another: the sag of that gravity.
TEST_F(Sag, HangsWhereTheDynamicsComeToRest) {
  const Pose rest = limb_pose({});
  DeviceChoice cpu;
  cpu.name = "cpu";
  JiggleOptions options;
  options.gravity_change = {0, kGravity, 0};
  Deformer jiggling(limb_model().basis, limb_model().dynamics, options, cpu);
  std::vector<float> hanging;
  for (int frame = 1; frame <= 240; ++frame) hanging = jiggling.jiggle({&rest, 1}, {&frame, 1}).positions;
  const std::vector<float> still = shown(limb_model().basis, rest),
                           sagging = shown(*basis_, driven(rest, {{"amount", 0}}));
  double most = 0, error = 0;
  for (std::size_t k = 0; k < still.size(); ++k) {
    most = std::max(most, double{std::abs(hanging[k] - still[k])});
    error = std::max(error, double{std::abs(hanging[k] - sagging[k])});
  }
  EXPECT_GT(most, 2e-4);  // or nothing hung
  EXPECT_LT(error, 0.03 * most + 4e-6);
}

// Gravity that is turned with the whole body is felt as before.
TEST_F(Sag, IsFeltInTheFrameOfTheJoint) {
  Pose lying = limb_pose({});
  lying.joints[0].rotation = axis_angle({1, 0, 0}, -std::numbers::pi / 2);
  const Pose felt = driven(lying, {{"amount", 0}}), standing = driven(limb_pose({}), {{"amount", 0}});
  for (std::size_t k = 0; k < felt.modifiers.size(); k += 3) {
    // A difference upwards is along z of a body whose back is turned down, and along y of one that stands.
    EXPECT_NEAR(standing.modifiers[k + 1], 1, 1e-6f);
    EXPECT_NEAR(felt.modifiers[k + 1], 0, 1e-6f);
    EXPECT_NEAR(felt.modifiers[k + 2], 1, 1e-6f);
  }
  const Pose tilted = driven(limb_pose({}), {{"forward", 90}});
  EXPECT_NEAR(tilted.modifiers[1], 1, 1e-6f);
  EXPECT_NEAR(tilted.modifiers[2], 1, 1e-6f);
  const Pose aside = driven(limb_pose({}), {{"sideways", 90}, {"amount", 2}});
  EXPECT_NEAR(aside.modifiers[0], 2, 1e-6f);
  EXPECT_NEAR(aside.modifiers[1], 1, 1e-6f);
}

TEST_F(Sag, ComponentsThatAreNotThreeToAJointAreRefused) {
  Basis damaged = *basis_;
  damaged.modifiers.stack[0].joints.push_back(0);
  std::vector<Pose> poses{limb_pose({})};
  EXPECT_EQ(kind_of([&] { drive_modifiers(damaged, {}, 24, poses); }), ErrorKind::mismatch);
}

TEST_F(Sag, DynamicsOfAnotherBodyAreRefused) {
  const TemporaryFolder folder;
  Dynamics other = limb_model().dynamics;
  save_dynamics(other, folder / "limb.dynamics.safetensors");
  std::ofstream(folder / "stack.json") << R"({"schema": "bodyopt-modifiers-1", "modifiers": [
      {"name": "flesh", "type": "sag", "dynamics": "limb.dynamics.safetensors"}]})";
  Basis basis = limb_model().basis;
  std::swap(basis.mesh.triangles[0], basis.mesh.triangles[1]);
  std::vector<std::string> notes;
  EXPECT_EQ(kind_of([&] { bake_stack(folder / "stack.json", basis, notes); }), ErrorKind::mismatch);
}

}  // namespace sag_test
}  // namespace bodyopt::testing
