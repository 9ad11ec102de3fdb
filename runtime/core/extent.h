// The size of a set of points.
#pragma once

#include <span>

namespace bodyopt {

// Diagonal of the box around points x, y, z, x, y, z, ..., in their unit; 0 of none.
double box_diagonal(std::span<const float> points);

}  // namespace bodyopt
