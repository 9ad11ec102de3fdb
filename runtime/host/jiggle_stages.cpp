#include "runtime/host/jiggle_stages.h"

#include <cmath>

#include "runtime/basis/dynamics.h"

namespace bodyopt {
namespace {

struct Coefficients {
  double d, b;

  // Right side of a stage that starts at u, v: count (m / d (v + d g) + inertia u / b). The trapezoidal rule has the
  // force at both its ends: count 2; BDF2 at its end alone: 1.
  void set_right_side(double count, JiggleStepPush& push) const {
    push.velocity_weight = static_cast<float>(count / d);
    push.displacement_weight = static_cast<float>(count / b);
  }
};

void set_result(double u_from_u, double u_from_z, double v_from_u, double v_from_z, double v_from_v,
                JiggleStepPush& push) {
  push.u_from_u = static_cast<float>(u_from_u);
  push.u_from_z = static_cast<float>(u_from_z);
  push.v_from_u = static_cast<float>(v_from_u);
  push.v_from_z = static_cast<float>(v_from_z);
  push.v_from_v = static_cast<float>(v_from_v);
}

}  // namespace

JiggleStepPush jiggle_frame(const Dynamics& dynamics, std::uint32_t fibre_count, std::uint32_t control_count,
                            std::uint32_t frame, const Vec3& gravity_change) {
  JiggleStepPush push{};
  push.node_count = dynamics.tets.node_count();
  push.frame = frame;
  push.fibre_count = fibre_count;
  push.control_count = control_count;
  push.gravity_x = static_cast<float>(gravity_change[0]);
  push.gravity_y = static_cast<float>(gravity_change[1]);
  push.gravity_z = static_cast<float>(gravity_change[2]);
  return push;
}

JiggleStages jiggle_stages(const JiggleStep& step, const JiggleStepPush& frame) {
  const double d = step.stage();
  const Coefficients stage{d, 1 + step.stiffness_damping / d};
  JiggleStepPush push = frame;
  push.duration = step.length();
  push.stage = step.stage();
  set_result(0, 0, 0, 0, 0, push);

  JiggleStages stages{push, std::nullopt, push};
  set_result(1 - 1 / stage.b, 1, -1 / (stage.b * d), 1 / d, 0, stages.end);
  if (step.implicit_euler) {
    stage.set_right_side(1, stages.begin);
    return stages;
  }
  stage.set_right_side(2, stages.begin);
  // The trapezoidal rule ends at u_g = (1 - 2 / b) u + z, v_g = (u_g - u) / d - v; BDF2 starts from c1 u_g - c0 u and
  // c1 v_g - c0 v, c1 = 1 / (gamma (2 - gamma)) and c0 = c1 - 1. c1 is rounded first: 1 - 2 c1 then is a float, too,
  // and an undamped mode does not grow by roundings.
  const double c1 = static_cast<float>((1 + std::sqrt(2.0)) / 2), c0 = c1 - 1;
  stages.advance = push;
  set_result(1 - 2 * c1 / stage.b, c1, -2 * c1 / (stage.b * d), c1 / d, -c1 - c0, *stages.advance);
  stage.set_right_side(1, *stages.advance);
  return stages;
}

}  // namespace bodyopt
