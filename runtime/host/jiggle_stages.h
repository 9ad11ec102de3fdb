// How one step of the jiggle is taken: the numbers that jiggle_begin, jiggle_advance and jiggle_end work with.
#pragma once

#include <optional>

#include "runtime/core/transform.h"
#include "shaders/include/layout.h"

namespace bodyopt {

struct Dynamics;
struct JiggleStep;

// A step is: begin, solve; where there is advance: advance, solve; end.
struct JiggleStages {
  JiggleStepPush begin;
  std::optional<JiggleStepPush> advance;  // of TR-BDF2; implicit Euler has one stage
  JiggleStepPush end;
};

// What jiggle_stages takes of a frame: its number in the arrays of the batch, their counts, and the change of gravity,
// m/s^2.
JiggleStepPush jiggle_frame(const Dynamics& dynamics, std::uint32_t fibre_count, std::uint32_t control_count,
                            std::uint32_t frame, const Vec3& gravity_change);

// TR-BDF2 (Bank et al. 1985) is the trapezoidal rule to gamma h, then BDF2 to h. Both stages share one system
// A = inertia + b K with b = 1 + beta / d, so that K u = (A - inertia) u / b: no product with K is needed.
// `frame` has the counts, the frame's number and gravity; the rest of it is not looked at.
JiggleStages jiggle_stages(const JiggleStep& step, const JiggleStepPush& frame);

}  // namespace bodyopt
