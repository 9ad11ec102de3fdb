// A square sheet of triangles, from -1 to 1 in x and y.
#pragma once

#include <vector>

#include "geometry/nearest_skin.h"

namespace bodyopt {

struct Sheet {
  Positions vertices;
  Triangles triangles;
  double edge = 0;
};

// side x side vertices. Its diagonals lie as in a mirror at x = 0.
inline Sheet flat_sheet(int side) {
  Sheet sheet;
  sheet.edge = 2.0 / (side - 1);
  sheet.vertices.resize(Eigen::Index{side} * side, 3);
  std::vector<std::uint32_t> corners;
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      sheet.vertices.row(Eigen::Index{y} * side + x) << sheet.edge * x - 1, sheet.edge * y - 1, 0;
      if (x + 1 == side || y + 1 == side) continue;
      const auto a = static_cast<std::uint32_t>(y * side + x), b = a + 1, c = a + static_cast<std::uint32_t>(side),
                 d = c + 1;
      if (2 * x + 1 < side) {
        corners.insert(corners.end(), {a, b, d, a, d, c});
      } else {
        corners.insert(corners.end(), {a, b, c, b, d, c});
      }
    }
  }
  sheet.triangles = Eigen::Map<const Triangles>(corners.data(), static_cast<Eigen::Index>(corners.size() / 3), 3);
  return sheet;
}

inline SkinPoint point_of(const Sheet& sheet, Eigen::Index triangle, const Eigen::Vector3d& weights) {
  SkinPoint point{triangle, {}, weights, Eigen::Vector3d::Zero()};
  for (int k = 0; k < 3; ++k) {
    point.vertices[static_cast<std::size_t>(k)] = sheet.triangles(triangle, k);
    point.position += weights[k] * sheet.vertices.row(sheet.triangles(triangle, k)).transpose();
  }
  return point;
}

}  // namespace bodyopt
