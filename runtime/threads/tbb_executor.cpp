#include "runtime/threads/tbb_executor.h"

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>

#ifdef BODYOPT_SANITIZED_THREADS
extern "C" void __tsan_acquire(void* address);
extern "C" void __tsan_release(void* address);
#endif

namespace bodyopt {
namespace {

// Tells ThreadSanitizer what happens before what: it does not see how oneTBB, which it does not instrument, hands work
// to threads and waits for them.
class HandOver {
 public:
#ifdef BODYOPT_SANITIZED_THREADS
  void give() { __tsan_release(this); }
  void take() { __tsan_acquire(this); }
#else
  void give() {}
  void take() {}
#endif
};

class TbbExecutor final : public Executor {
 public:
  void parallel_for(std::size_t count, std::size_t grain, Task task, const void* context) override {
    if (count <= grain) {
      if (count > 0) task(context, 0, count);
      return;
    }
    // A range is halved while it is longer than oneTBB's grain.
    const tbb::blocked_range<std::size_t> range(0, count, 2 * grain - 1);
    HandOver work, results;
    work.give();
    tbb::this_task_arena::isolate([&] {
      tbb::parallel_for(range, [&](const auto& part) {
        work.take();
        task(context, part.begin(), part.end());
        results.give();
      });
    });
    results.take();
  }
};

}  // namespace

std::unique_ptr<Executor> make_tbb_executor() { return std::make_unique<TbbExecutor>(); }

std::size_t thread_count() {
  const int slots = tbb::this_task_arena::max_concurrency();
  return std::min(static_cast<std::size_t>(slots),
                  tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
}

}  // namespace bodyopt
