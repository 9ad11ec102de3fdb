// An upright box around points.
#pragma once

#include <algorithm>

#include "runtime/core/transform.h"

namespace bodyopt {

struct Box {
  Vec3 low{1e30, 1e30, 1e30}, high{-1e30, -1e30, -1e30};  // of no point

  void add(const Vec3& point) {
    for (std::size_t i = 0; i < 3; ++i) {
      low[i] = std::min(low[i], point[i]);
      high[i] = std::max(high[i], point[i]);
    }
  }
  Vec3 middle() const { return 0.5 * (low + high); }
  double radius() const { return 0.5 * length(high - low); }
};

}  // namespace bodyopt
