// Direct Delta Mush as printed (Le & Lewis 2019, v0): 4 x 4 moments about the origin, in double precision, the rotation
// by a singular value decomposition. Independent of the centred form that the runtime uses.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "runtime/basis/basis.h"

namespace bodyopt::testing {

// The rotation nearest to A.
Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& a);

// How well determined the nearest rotation is: (s2 + s3) / s1 with the sign of det A on s3; 0 when any will do.
double rotation_gap(const Eigen::Matrix3d& a);

struct TextbookPosition {
  Eigen::Vector3d position;  // relative to the frame's origin
  double gap;
};

// skinning: J x 12 of one frame.
TextbookPosition textbook_ddm(const DdmTable& ddm, std::uint32_t vertex, const float* skinning,
                              const Eigen::Vector3d& delta);

}  // namespace bodyopt::testing
