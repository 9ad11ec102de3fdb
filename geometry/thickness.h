// How thick a body is behind its skin.
#pragma once

#include "geometry/mesh.h"

namespace bodyopt {

// Per vertex, metres: along its normal to the skin behind it, averaged over the skin within about `nearby` of the
// body's extent (the shape diameter: Shapira, Shamir, Cohen-Or 2008, with one ray; a ray alone sees every ear and
// finger), between a 180th and a sixth of the extent. Of a skin of many vertices some are measured, evenly spread.
Eigen::VectorXd thickness(const Positions& vertices, const Triangles& triangles, double nearby = 0.04);

}  // namespace bodyopt
