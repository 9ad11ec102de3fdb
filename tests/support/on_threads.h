// Work on a number of threads, however many cores there are.
#pragma once

#include <tbb/global_control.h>
#include <tbb/task_arena.h>

namespace bodyopt::testing {

template <typename Work>
auto on_threads(int count, const Work& work) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(count));
  return tbb::task_arena(count).execute(work);
}

}  // namespace bodyopt::testing
