#include "runtime/host/fade.h"

#include <gtest/gtest.h>

#include <cmath>

#include "runtime/deformer/deformer.h"
#include "runtime/host/rig.h"
#include "tests/support/small_basis.h"

namespace bodyopt::testing {
namespace {

// A chain of three joints that turn (and a root), of which training saw everything but what the rows tell.
struct Chain {
  explicit Chain(std::uint32_t seed) : random(seed) {
    FadeTable& fade = residual.fade;
    fade.joint_begin = {0, 2, 5, 7};
    fade.joints = {0, 1, 1, 0, 2, 2, 1};
    fade.direction_begin = {0, 1, 3, 3};
    fade.directions = random.floats(18 + 2 * 27, -1, 1);
    fade.tolerance = {0.01f, 0.0f, 0.3f};
    fade.region_begin = {0, 2, 3, 3};
    fade.region_joints = {0, 2, 1};
    fade.region_weights = {2.0f, 0.5f, 7.0f};
    for (int k = 0; k < 27; ++k) residual.features.push_back({-0.4f, 0.5f, 0.0f, 1.0f});
    residual.regions.resize(3);
    features = random.floats(27, -1, 1);
  }

  // As basis.h has it, in double precision.
  double off(std::size_t joint) const {
    const FadeTable& fade = residual.fade;
    double sum = 0;
    std::size_t number = 0;
    for (std::size_t j = 0; j < 3; ++j) {
      for (std::uint32_t row = fade.direction_begin[j]; row < fade.direction_begin[j + 1]; ++row) {
        double along = 0;
        for (std::uint32_t n = fade.joint_begin[j]; n < fade.joint_begin[j + 1]; ++n) {
          for (std::size_t k = 0; k < 9; ++k, ++number) {
            along += double{fade.directions[number]} * double{features[9 * fade.joints[n] + k]};
          }
        }
        if (j == joint) sum += along * along;
      }
    }
    for (std::size_t k = 9 * joint; k < 9 * joint + 9; ++k) {
      const double inside = std::min(std::max(double{features[k]}, -0.4), 0.5);
      sum += std::pow(double{features[k]} - inside, 2);
    }
    return std::max(0.0, sum - double{fade.tolerance[joint]});
  }

  Random random;
  ResidualTable residual;
  std::vector<float> features;
};

TEST(Fade, EqualsTheTextbook) {
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    const Chain chain(seed);
    const std::vector<double> off = joints_off(chain.residual, chain.features);
    ASSERT_EQ(off.size(), 3u);
    for (std::size_t j = 0; j < 3; ++j) EXPECT_NEAR(off[j], chain.off(j), 1e-6);
    const std::vector<float> fades = region_fades(chain.residual, chain.features);
    ASSERT_EQ(fades.size(), 3u);
    EXPECT_NEAR(fades[0], 1 / (1 + 2.0 * chain.off(0) + 0.5 * chain.off(2)), 1e-6);
    EXPECT_NEAR(fades[1], 1 / (1 + 7.0 * chain.off(1)), 1e-6);
    EXPECT_EQ(fades[2], 1.0f);  // minds no joint
  }
}

TEST(Fade, WithoutATableNothingFades) {
  Chain chain(1);
  chain.residual.fade = {};
  EXPECT_TRUE(joints_off(chain.residual, chain.features).empty());
  EXPECT_EQ(region_fades(chain.residual, chain.features), std::vector<float>(3, 1.0f));
}

// The skin of a pose that the small basis knows is whole; bent the other way the second region fades, and nothing but
// its displacement does.
TEST(Fade, TakesTheRegionsDisplacementAlong) {
  const Basis basis = small_basis();
  Basis lasting = basis;
  lasting.residual.fade = {};
  Deformer fading_deformer(basis, {.name = "cpu"}), lasting_deformer(lasting, {.name = "cpu"});
  const auto bent = [&](const Vec3& axis, double angle) {
    Pose pose = bind_pose(basis.skeleton);
    const Quat world = bind_rotations(basis.skeleton)[1];
    pose.joints[1].rotation =
        normalized(pose.joints[1].rotation * (conjugate(world) * axis_angle(axis, angle) * world));
    return pose;
  };
  const auto both = [&](const Pose& pose) {
    return std::pair(fading_deformer.evaluate({&pose, 1}), lasting_deformer.evaluate({&pose, 1}));
  };
  const auto [known, whole] = both(bent({0, 0, 1}, 0.5));
  EXPECT_EQ(known.fades, std::vector<float>(2, 1.0f));
  EXPECT_EQ(known.positions, whole.positions);

  const auto [unknown, unfaded] = both(bent({1, 0, 0}, 0.5));
  ASSERT_EQ(unknown.fades[0], 1.0f);
  // R - 1 about x by 0.5: entries (1, 2) and (2, 1) are -+sin, (1, 1) and (2, 2) cos - 1.
  const double off = std::pow(0.6 * std::sin(0.5) + 0.8 * std::sin(0.5), 2) - 0.01;
  EXPECT_NEAR(unknown.fades[1], 1 / (1 + 3 * off), 1e-5);
  EXPECT_NE(unknown.positions, unfaded.positions);
}

}  // namespace
}  // namespace bodyopt::testing
