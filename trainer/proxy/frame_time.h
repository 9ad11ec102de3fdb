// How long a frame takes on this machine.
#pragma once

#include "runtime/basis/basis.h"

namespace bodyopt {

struct FrameTime {
  double microseconds = 0;  // of a frame, all stages, on the CPU
  int threads = 1;
};

// Of the bind pose (any pose takes as long), the best of three batches of 32.
FrameTime frame_time(const Basis& basis);

}  // namespace bodyopt
