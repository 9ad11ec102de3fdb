// How thick a body is behind its skin.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "geometry/nearest_skin.h"

namespace bodyopt {

// Per vertex, metres: the shape diameter (Shapira, Shamir, Cohen-Or 2008), here with one ray, along the normal to the
// skin behind it. A ray alone sees every ear and finger, so lengths are averaged over the skin within about `nearby` of
// the body's extent. They are between a 180th and a sixth of it. Of many vertices, evenly spread ones are measured.
Eigen::VectorXd thickness(const Positions& vertices, const Triangles& triangles, double nearby = 0.04);

// Per vertex, metres: the medial radius, the largest depth reached by walking inwards along the normal. The walk ends
// where the depth falls below 0.8 of the way. A ray's length tells no depth, so thickness() does not give it. `skin`
// must be of the same arrays.
Eigen::VectorXd half_thickness(const Positions& vertices, const Triangles& triangles, const NearestSkin& skin);

// How deep a point lies under the skin.

// Inside is where the winding number (Jacobson, Kavan, Sorkine-Hornung 2013) is above 1/2 or below -1/2. Small holes in
// the skin do not matter, nor that it is inside out.
class SkinDepth {
 public:
  // vertices and triangles must outlive it.
  SkinDepth(const Positions& vertices, const Triangles& triangles);
  SkinDepth(const SkinDepth&) = delete;
  SkinDepth& operator=(const SkinDepth&) = delete;

  // Distance to the skin, metres: positive inside.
  double operator()(const Eigen::Vector3d& point) const;

  // Returns the point itself where it is deep enough, otherwise the point `depth` under the skin nearest to it. It is
  // less deep where the body is too thin for that, and nothing where there is no place inside near it.
  std::optional<Eigen::Vector3d> tuck(const Eigen::Vector3d& point, double depth) const;

 private:
  double winding_number(const Eigen::Vector3d& point) const;
  const Positions& vertices_;
  const Triangles& triangles_;
  NearestSkin nearest_;
};

}  // namespace bodyopt
