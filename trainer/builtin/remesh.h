// Isotropic remeshing: well-shaped triangles of wanted sizes on a solid's surface.
#pragma once

#include <functional>
#include <vector>

#include "trainer/builtin/implicit.h"
#include "trainer/builtin/march.h"

namespace bodyopt {

using EdgeLength = std::function<double(const Eigen::Vector3d&)>;  // metres, wanted at a point

// Splits long edges, collapses short ones, flips, and moves points along the surface and back onto it (Botsch and
// Kobbelt 2004). Keeps the surface closed, manifold and of the same genus. `surface` has to be closed.
Surface remesh(Surface surface, const Solid& solid, const EdgeLength& edge_length, int rounds);

}  // namespace bodyopt
