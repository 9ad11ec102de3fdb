// A loop over independent items on all cores, with progress.
#pragma once

#include <exception>
#include <string>

#include "trainer/progress.h"

namespace bodyopt {

// Calls body(k) for 0 <= k < count in any order. The first exception ends the loop and is thrown again here. Results
// do not depend on the number of threads as long as body(k) writes only what belongs to k.
template <typename Body>
void parallel_for(const std::string& label, std::size_t count, const Body& body) {
  Progress progress(label, count);
  std::exception_ptr failure;
#pragma omp parallel for schedule(dynamic)
  for (std::size_t k = 0; k < count; ++k) {
    bool stop = false;
#pragma omp critical(bodyopt_parallel_for)
    stop = failure != nullptr;
    if (stop) continue;
    try {
      body(k);
#pragma omp critical(bodyopt_parallel_for)
      {
        // An exception must not leave the critical section.
        try {
          progress.advance();
        } catch (...) {
          failure = std::current_exception();
        }
      }
    } catch (...) {
#pragma omp critical(bodyopt_parallel_for)
      failure = std::current_exception();
    }
  }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace bodyopt
