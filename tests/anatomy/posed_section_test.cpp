#include <gtest/gtest.h>

#include "runtime/host/rig.h"
#include "tests/support/capsule_limb.h"
#include "trainer/anatomy/section.h"
#include "trainer/train/skinning/unpose.h"

namespace bodyopt::trainer {
namespace {

class PosedSection : public ::testing::Test {
 protected:
  RestPoints back(const SectionPlane& plane) const { return rest_points(plane, PosedBody{limb_, skin_, skinning_}); }
  SectionPlane across(const Eigen::Vector3d& middle) const {
    return plane_around(middle, Eigen::Vector3d::UnitX(), -Eigen::Vector3d::UnitY(), {0.3, 0.3}, 2e-3);
  }

  const Character limb_ = limb_character();
  const Pose pose_ = limb_pose(limb_.skeleton, 0.8, 0, 0);
  const std::vector<Affine> skinning_ = skinning_matrices(limb_.skeleton, pose_.joints);
  Positions skin_ = skin_linear(limb_, pose_);
};

// Where one joint alone holds the skin, pixels go back with that: as many as the skin encloses.
TEST_F(PosedSection, PixelsGoBackWithTheirJoints) {
  constexpr double kSides = kLimbSides;
  const double area = 0.5 * kSides * kLimbRadius * kLimbRadius * std::sin(2 * EIGEN_PI / kSides);
  for (const auto& [joint, height] : {std::pair<std::size_t, double>(0, 0.12), {1, 0.4}}) {
    const SectionPlane at_rest = across({0, 0, height});
    const SectionPlane plane = moved_plane(at_rest, skinning_[joint]);
    const RestPoints points = back(plane);
    int inside = 0;
    for (int pixel = 0; pixel < plane.size(); ++pixel) {
      const auto& point = points[static_cast<std::size_t>(pixel)];
      if (!point || at_rest.middle(pixel).head<2>().norm() > 1.2 * kLimbRadius) continue;  // of another part
      ++inside;
      EXPECT_LT((point->position - at_rest.middle(pixel)).norm(), 1e-9) << joint;
    }
    EXPECT_NEAR(inside * plane.pixel * plane.pixel, area, 0.02 * area) << joint;
  }
}

// Skin that bulges beyond what its joints do comes back to where it was at rest, and so does what is next to it.
TEST_F(PosedSection, WhatTheSkinDoesBesideIsTakenBack) {
  const Positions blended = skin_;
  for (Eigen::Index v = 0; v < skin_.rows(); ++v) {
    if (limb_.weights[static_cast<std::size_t>(v)].front().joint != 0) continue;
    const Eigen::Vector3d radial(skin_(v, 0), skin_(v, 1), 0);
    skin_.row(v) += 0.01 * radial.normalized().transpose();
  }
  const double low = blended.col(2).minCoeff();
  const SectionPlane plane = across({0, 0, low + 0.12});
  double furthest = 0;
  for (const auto& point : back(plane)) {
    if (point) furthest = std::max(furthest, point->position.head<2>().norm());
  }
  EXPECT_GT(furthest, kLimbRadius - 4e-3);
  EXPECT_LT(furthest, kLimbRadius + 1e-4);
}

// Nothing is inside of nothing.
TEST_F(PosedSection, APlaneBesideMisses) {
  for (const auto& point : back(across({0, 0, skin_.col(2).maxCoeff() + 0.01}))) EXPECT_FALSE(point);
}

}  // namespace
}  // namespace bodyopt::trainer
