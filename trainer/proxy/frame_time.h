// How long a frame takes on this machine.
#pragma once

#include "runtime/basis/levels.h"

namespace bodyopt {

struct FrameTime {
  double microseconds = 0;  // of a frame, all stages, on the CPU
  double carrying = 0;      // microseconds of carrying the full skin, on top; 0 where there is none
  int threads = 1;
};

// Of the bind pose (any pose takes as long), the best of three batches of 32.
FrameTime frame_time(const Level& level);

}  // namespace bodyopt
