// How one of the cast stands and plays while it is not the lead, and what of it a session keeps.
#pragma once

#include <optional>

#include "runtime/core/transform.h"

namespace bodyopt {

struct Standing {
  std::optional<Vec3> at;  // where its root begins, its ground for the height, metres, world; none: where there is room
  std::optional<int> ahead;  // frames ahead of the lead, round and round in its own clip; none: frame by frame
  std::optional<int> level;  // of detail, 0 the finest; none: as its size in the picture asks
  bool operator==(const Standing&) const = default;
};

}  // namespace bodyopt
