#include "proxy_viewer/state/mirrored_angles.h"

#include "proxy_viewer/state/euler_angles.h"

namespace bodyopt {
namespace {

// At x = 0: an axis is reflected, and the sense of turning as well.
Quat reflected(const Quat& turn) { return {turn[0], -turn[1], -turn[2], turn[3]}; }

}  // namespace

Vec3 mirrored_angles(const Vec3& degrees, const Quat& axes, const Quat& other_axes) {
  const Quat in_world = axes * turn_of(degrees) * conjugate(axes);
  return degrees_of(conjugate(other_axes) * reflected(in_world) * other_axes);
}

}  // namespace bodyopt
