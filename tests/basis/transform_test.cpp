#include "runtime/core/transform.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "runtime/core/half.h"
#include "tests/support/error_kind.h"

namespace bodyopt {
namespace {

void expect_near(const Affine& a, const Affine& b, double tolerance) {
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 4; ++j) EXPECT_NEAR(a.m[i][j], b.m[i][j], tolerance);
  }
}

TEST(Transform, DecomposeRestoresTranslationRotationAndScale) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int trial = 0; trial < 1000; ++trial) {
    JointTransform t;
    t.translation = {uniform(random), uniform(random), uniform(random)};
    t.rotation = normalized({uniform(random), uniform(random), uniform(random), uniform(random)});
    t.scale = {1.5 + uniform(random), 1.5 + uniform(random), 1.5 + uniform(random)};
    const Affine a = affine_from(t);
    expect_near(affine_from(decompose(a)), a, 1e-10);
    expect_near(a * inverse(a), Affine{}, 1e-10);
  }
}

TEST(Transform, SingularMatricesAreRefusedOrCollapsed) {
  Affine flat;
  flat.m[2][2] = 0;
  EXPECT_EQ(testing::kind_of([&] { (void)inverse(flat); }), ErrorKind::mismatch);
  EXPECT_EQ(decompose(flat).scale, (Vec3{0, 0, 0}));
}

TEST(Transform, RotateAgreesWithTheMatrix) {
  const Quat q = axis_angle({1, -2, 0.5}, 1.3);
  const Vec3 v{0.3, -0.7, 2};
  const auto r = rotation_matrix(q);
  const Vec3 turned = rotate(q, v);
  for (int i = 0; i < 3; ++i)
    EXPECT_NEAR(turned[static_cast<std::size_t>(i)], dot(r[static_cast<std::size_t>(i)], v), 1e-12);
  EXPECT_NEAR(length(rotate(axis_angle({0, 0, 1}, M_PI / 2), {1, 0, 0}) - Vec3{0, 1, 0}), 0, 1e-12);
}

TEST(Transform, SlerpTurnsByAShareOfTheAngle) {
  const Vec3 axis{0.3, 1, -0.2};
  for (const double angle : {0.07, 1.0, 3.1}) {
    for (const double share : {0.0, 1e-9, 0.1, 1.0 / 3, 0.5, 0.8, 1.0}) {
      const Quat turned = slerp({0, 0, 0, 1}, axis_angle(axis, angle), share);
      const Quat expected = axis_angle(axis, share * angle);
      for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(turned[i], expected[i], 2e-15) << angle << " " << share;
    }
  }
}

TEST(Half, EveryHalfSurvivesTheRoundTrip) {
  for (std::uint32_t h = 0; h < 65536; ++h) {
    const float value = float_from_half(h);
    if (std::isnan(value)) continue;
    EXPECT_EQ(half_from_float(value), h);
  }
}

TEST(Half, RoundsToTheNearestHalf) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<float> exponent(-18, 15.9f), mantissa(-1, 1);
  for (int trial = 0; trial < 100000; ++trial) {
    const float value = std::ldexp(mantissa(random), static_cast<int>(exponent(random)));
    const std::uint32_t h = half_from_float(value);
    const double error = std::abs(static_cast<double>(float_from_half(h)) - static_cast<double>(value));
    for (const std::uint32_t neighbour : {h - 1, h + 1}) {
      if (((neighbour ^ h) & 0x8000u) != 0 || (neighbour & 0x7c00u) == 0x7c00u) continue;
      const double other = std::abs(static_cast<double>(float_from_half(neighbour)) - static_cast<double>(value));
      EXPECT_LE(error, other);
    }
  }
  EXPECT_TRUE(std::isinf(float_from_half(half_from_float(1e6f))));
}

}  // namespace
}  // namespace bodyopt
