// The point of a triangle mesh nearest to a point in space.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "runtime/basis/basis.h"

namespace bodyopt {

struct SurfacePoint {
  std::uint32_t triangle = 0;
  Eigen::Vector3d weights = Eigen::Vector3d::Zero();  // barycentric, sum 1
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  double distance = 0;  // metres
};

class ClosestPoint {
 public:
  explicit ClosestPoint(const MeshTable& mesh);  // kept by reference; at least one triangle
  SurfacePoint find(const Eigen::Vector3d& point) const;

 private:
  struct Sphere {
    Eigen::Vector3d centre;
    double radius;
  };
  Eigen::Vector3d corner(std::size_t triangle, int k) const;
  const MeshTable& mesh_;
  std::vector<Sphere> spheres_;  // around each triangle
};

}  // namespace bodyopt
