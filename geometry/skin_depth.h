// How deep a point lies under the skin.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "geometry/nearest_skin.h"

namespace bodyopt {

// Inside is where the winding number (Jacobson, Kavan, Sorkine-Hornung 2013) is above one half, or below minus that:
// small holes in the skin do not matter, nor that it is inside out.
class SkinDepth {
 public:
  // vertices and triangles must outlive it.
  SkinDepth(const Positions& vertices, const Triangles& triangles);
  SkinDepth(const SkinDepth&) = delete;
  SkinDepth& operator=(const SkinDepth&) = delete;

  // Distance to the skin, metres: positive inside.
  double operator()(const Eigen::Vector3d& point) const;

  // The point itself where it is deep enough, otherwise the point `depth` under the skin nearest to it; less deep where
  // the body is too thin for that; nothing where there is no place inside near it.
  std::optional<Eigen::Vector3d> tuck(const Eigen::Vector3d& point, double depth) const;

 private:
  double winding_number(const Eigen::Vector3d& point) const;
  const Positions& vertices_;
  const Triangles& triangles_;
  NearestSkin nearest_;
};

}  // namespace bodyopt
