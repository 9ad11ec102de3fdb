// A parallel loop that lets exceptions out.
#pragma once

#include <omp.h>

#include <atomic>
#include <cstddef>
#include <exception>

namespace bodyopt {

// body(k) for k in 0 .. count - 1, on so many threads (0: on all cores), in no particular order. The first exception is
// thrown again at the end; iterations not begun by then are left out. None may be thrown in an OpenMP critical section:
// it ends the program.
template <typename Body>
void parallel_for(std::size_t count, const Body& body, int threads = 0) {
  std::atomic<bool> failed{false};
  std::exception_ptr failure;
  const int wanted = threads > 0 ? threads : omp_get_max_threads();
#pragma omp parallel for schedule(dynamic) num_threads(wanted)
  for (std::size_t k = 0; k < count; ++k) {
    if (failed) continue;
    try {
      body(k);
    } catch (...) {
#pragma omp critical(bodyopt_parallel_for)
      if (!failed.exchange(true)) failure = std::current_exception();
    }
  }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace bodyopt
