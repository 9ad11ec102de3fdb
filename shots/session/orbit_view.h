// Where a camera stands that goes around a point, as a session keeps it.
#pragma once

#include "runtime/core/transform.h"

namespace bodyopt {

struct OrbitView {
  static constexpr double kNearest = 0.01, kFarthest = 1e5;  // metres, of the distance

  Vec3 target{0, 0, 0};       // metres, world
  double distance = 3;        // metres, from the eye to the target
  double azimuth = 0;         // radians: 0 from the front (+z), pi / 2 from the character's left (+x)
  double elevation = 0;       // radians above the horizon
  bool orthographic = false;  // at the target things look as large as in perspective
  bool cut_away = false;      // what stands before the target is cut away

  bool operator==(const OrbitView&) const = default;
};

}  // namespace bodyopt
