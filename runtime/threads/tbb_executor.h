// oneTBB's threads, which the program, and hosts that use it too (Houdini, Maya, USD, Blender), share.
#pragma once

#include <memory>

#include "runtime/core/executor.h"

namespace bodyopt {

// Runs on thread_count() threads. One that waits for the others does no work but of its own loop: it may hold a lock.
std::unique_ptr<Executor> make_tbb_executor();

// The number of oneTBB's threads: tbb::global_control and the calling thread's arena decide it.
std::size_t thread_count();

}  // namespace bodyopt
