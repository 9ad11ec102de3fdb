// How thick a body is behind its skin.
#pragma once

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

}  // namespace bodyopt
