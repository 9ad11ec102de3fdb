// Marching tetrahedra: a first, closed triangle mesh of a solid.
#pragma once

#include <Eigen/Core>

#include "geometry/remesh.h"
#include "trainer/builtin/implicit.h"

namespace bodyopt {

// Closed and manifold whatever the solid, for each cube of the grid is cut into six tetrahedra. The grid covers the box
// from `low` to `high`, which has to contain the solid. `step` metres between nodes. The mesh lies `depth` metres below
// the surface, where gaps narrower than a step (between fingers) are wider.
Surface march(const Solid& solid, const Eigen::Vector3d& low, const Eigen::Vector3d& high, double step, double depth);

}  // namespace bodyopt
