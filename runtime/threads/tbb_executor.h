// oneTBB's threads, which the program, and hosts that use it too (Houdini, Maya, USD, Blender), share.
#pragma once

#include <memory>

#include "runtime/core/executor.h"

namespace bodyopt {

// As many threads as oneTBB has: tbb::global_control and the calling thread's arena say how many.
std::unique_ptr<Executor> make_tbb_executor();

}  // namespace bodyopt
