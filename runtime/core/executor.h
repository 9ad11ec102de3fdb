// Threads that the runtime works on: those of the host program where it lends some.
#pragma once

#include <algorithm>
#include <cstddef>

namespace bodyopt {

class Executor {
 public:
  // Does elements [begin, end). Throws nothing.
  using Task = void (*)(const void* context, std::size_t begin, std::size_t end);

  virtual ~Executor() = default;
  // Calls the task for parts that cover [0, count) once, on any threads and in any order; returns when all are done. No
  // part is smaller than `grain` elements unless `count` is. May be called from several threads at once.
  virtual void parallel_for(std::size_t count, std::size_t grain, Task task, const void* context) = 0;
};

// Runs everything on the calling thread.
class SerialExecutor final : public Executor {
 public:
  void parallel_for(std::size_t count, std::size_t, Task task, const void* context) override {
    if (count > 0) task(context, 0, count);
  }
};

inline Executor& calling_thread() {
  static SerialExecutor executor;
  return executor;
}

// Calls function(begin, end) for every part.
template <typename Function>
void parallel_parts(Executor& executor, std::size_t count, std::size_t grain, const Function& function) {
  const auto task = [](const void* context, std::size_t begin, std::size_t end) {
    (*static_cast<const Function*>(context))(begin, end);
  };
  executor.parallel_for(count, grain, task, &function);
}

// Calls function(k) for every element.
template <typename Function>
void parallel_each(Executor& executor, std::size_t count, std::size_t grain, const Function& function) {
  parallel_parts(executor, count, grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) function(k);
  });
}

// Calls function(frame, first, count) for all pieces of `size` elements of every frame, the last of a frame smaller.
// All frames of a piece come one after the other: a cache then has its tables for all but the first.
template <typename Function>
void parallel_pieces(Executor& executor, std::size_t frames, std::size_t elements, std::size_t size,
                     const Function& function) {
  const std::size_t pieces = (elements + size - 1) / size;
  parallel_each(executor, frames * pieces, 1, [&](std::size_t k) {
    const std::size_t first = k / frames * size;
    function(k % frames, first, std::min(size, elements - first));
  });
}

}  // namespace bodyopt
