#include "runtime/core/extent.h"

#include <algorithm>
#include <cmath>

namespace bodyopt {

double box_diagonal(std::span<const float> points) {
  double squared = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    float low = points.empty() ? 0 : points[axis], high = low;
    for (std::size_t k = axis; k < points.size(); k += 3) {
      low = std::min(low, points[k]);
      high = std::max(high, points[k]);
    }
    const double length = static_cast<double>(high) - static_cast<double>(low);
    squared += length * length;
  }
  return std::sqrt(squared);
}

}  // namespace bodyopt
