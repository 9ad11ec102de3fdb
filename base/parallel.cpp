#include "base/parallel.h"

#include <algorithm>
#include <atomic>
#include <exception>

#include "runtime/threads/tbb_executor.h"

namespace bodyopt {

void parallel_for(std::size_t count, const std::function<void(std::size_t)>& body, int threads) {
  static const std::unique_ptr<Executor> executor = make_tbb_executor();
  std::atomic<std::size_t> next{0};
  std::atomic<bool> failed{false};
  std::exception_ptr failure;
  // A part is a thread, which takes iterations while there are any.
  const std::size_t parts = std::min(count, threads > 0 ? static_cast<std::size_t>(threads) : thread_count());
  parallel_parts(*executor, parts, 1, [&](std::size_t, std::size_t) {
    for (std::size_t k = next++; k < count && !failed; k = next++) {
      try {
        body(k);
      } catch (...) {
        if (!failed.exchange(true)) failure = std::current_exception();
      }
    }
  });
  if (failure) std::rethrow_exception(failure);
}

void parallel_for_short(std::size_t count, const std::function<void(std::size_t)>& body) {
  constexpr std::size_t kTogether = 512;
  parallel_for((count + kTogether - 1) / kTogether, [&](std::size_t block) {
    for (std::size_t k = block * kTogether; k < std::min(count, (block + 1) * kTogether); ++k) body(k);
  });
}

}  // namespace bodyopt
