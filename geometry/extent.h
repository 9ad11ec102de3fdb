// How large a set of points is.
#pragma once

#include <Eigen/Core>

#include "geometry/mesh.h"

namespace bodyopt {

// Of the bounding box, in the points' unit; 0 of no points.
Eigen::RowVector3d box_sides(const Positions& points);
double longest_extent(const Positions& points);
double box_diagonal(const Positions& points);

}  // namespace bodyopt
