// A parallel loop that lets exceptions out.
#pragma once

#include <cstddef>
#include <functional>

namespace bodyopt {

// body(k) for k in 0 .. count - 1, begun in this order, on so many threads at most (0: on all). The first exception is
// thrown again at the end; iterations not begun by then are left out.
void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body, int threads = 0);
// parallel_for() for iterations so short that a thread takes many of them at a time.
void parallel_for_short(std::size_t count, const std::function<void(std::size_t)>& body);

}  // namespace bodyopt
