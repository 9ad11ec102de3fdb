// Tables of a basis as matrices, and back.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "geometry/mesh.h"

namespace bodyopt {

// Points, #V x 3.
inline Positions rows_of(const std::vector<float>& values) {
  return Eigen::Map<const Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>>(
             values.data(), static_cast<Eigen::Index>(values.size() / 3), 3)
      .cast<double>();
}

inline Triangles rows_of(const std::vector<std::uint32_t>& corners) {
  return Eigen::Map<const Triangles>(corners.data(), static_cast<Eigen::Index>(corners.size() / 3), 3);
}

// 3 V.
inline std::vector<float> floats_of(const Positions& points) { return {points.data(), points.data() + points.size()}; }

}  // namespace bodyopt
