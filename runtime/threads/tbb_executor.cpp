#include "runtime/threads/tbb_executor.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace bodyopt {
namespace {

class TbbExecutor final : public Executor {
 public:
  void parallel_for(std::size_t count, std::size_t grain, Task task, const void* context) override {
    // A range is halved while it is longer than oneTBB's grain.
    const tbb::blocked_range<std::size_t> range(0, count, 2 * grain);
    tbb::parallel_for(range, [=](const auto& part) { task(context, part.begin(), part.end()); });
  }
};

}  // namespace

std::unique_ptr<Executor> make_tbb_executor() { return std::make_unique<TbbExecutor>(); }

}  // namespace bodyopt
