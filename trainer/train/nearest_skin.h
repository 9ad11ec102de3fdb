// The point of the skin nearest to a point in space.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "trainer/dataset/character.h"

namespace bodyopt {

struct SkinPoint {
  std::array<std::uint32_t, 3> vertices{};
  Eigen::Vector3d weights = Eigen::Vector3d::Zero();  // barycentric, >= 0, sum 1
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
};

// Nearest-triangle search: every triangle, most rejected by its bounding sphere. There must be a triangle.
class NearestSkin {
 public:
  NearestSkin(const Positions& vertices, const Triangles& triangles);
  SkinPoint operator()(const Eigen::Vector3d& point) const;

 private:
  struct Sphere {
    Eigen::Vector3d centre;
    double radius;
  };
  const Positions& vertices_;
  const Triangles& triangles_;
  std::vector<Sphere> spheres_;
};

}  // namespace bodyopt
