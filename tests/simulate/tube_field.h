// What lies inside the limb of limb.h, made up: bone along its axis, a muscle beside it, fat around both.
#pragma once

#include <Eigen/Geometry>

#include "tests/simulate/limb.h"
#include "trainer/simulate/tet_tissue.h"

namespace bodyopt {

constexpr double kBoneRadius = 0.012, kBellyRadius = 0.011, kBellyOff = 0.024;  // metres; off the axis, towards +y
constexpr double kBellyFrom = 0.05, kBellyTo = 0.22;                            // along x

// Bone of joint 0 up to the elbow, of joint 1 beyond; muscle 0 is a cylinder whose fibres run along x.
inline trainer::PointTissue tube_tissue(const Eigen::Vector3d& point) {
  if (point.tail<2>().norm() > kTubeRadius || point[0] < 0 || point[0] > kTubeLength) return {};
  if (point.tail<2>().norm() < kBoneRadius)
    return {{trainer::TissueKind::bone, point[0] < kTubeLength / 2 ? 0 : 1, -1}};
  const bool is_beside = (point.tail<2>() - Eigen::Vector2d(kBellyOff, 0)).norm() < kBellyRadius;
  if (is_beside && point[0] > kBellyFrom && point[0] < kBellyTo) {
    return {{trainer::TissueKind::muscle, -1, 0}, Eigen::Vector3d::UnitX()};
  }
  return {{trainer::TissueKind::fat, -1, -1}};
}

}  // namespace bodyopt
