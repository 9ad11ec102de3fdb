// How thick a body is behind its skin.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "geometry/nearest_skin.h"

namespace bodyopt {

// Per vertex, metres: along its normal to the skin behind it, averaged over the skin within about `nearby` of the
// body's extent (the shape diameter: Shapira, Shamir, Cohen-Or 2008, with one ray; a ray alone sees every ear and
// finger), between a 180th and a sixth of the extent. Of a skin of many vertices some are measured, evenly spread.
Eigen::VectorXd thickness(const Positions& vertices, const Triangles& triangles, double nearby = 0.04);

// Per vertex, metres: the medial radius, that is the largest depth reached by walking inwards along the normal while
// the depth keeps up with 0.8 of the way. A ray's length tells no depth, so thickness() does not give it. `skin` must
// be of the same arrays.
Eigen::VectorXd half_thickness(const Positions& vertices, const Triangles& triangles, const NearestSkin& skin);

// How deep a point lies under the skin.

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
