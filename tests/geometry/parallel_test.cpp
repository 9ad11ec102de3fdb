#include "base/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <mutex>
#include <numeric>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "tests/support/on_threads.h"

namespace bodyopt::testing {
namespace parallel_test {

TEST(ParallelFor, DoesEachOnceOnAnyNumberOfThreads) {
  for (const std::size_t count : {0, 1, 2, 3, 1000}) {
    for (const int threads : {0, 1, 2, 7}) {
      std::vector<std::atomic<int>> done(count);
      parallel_for(
          count, [&](std::size_t k) { ++done[k]; }, threads);
      for (const std::atomic<int>& times : done) EXPECT_EQ(times, 1);
    }
  }
}

TEST(ParallelFor, BeginsInOrder) {
  std::vector<std::size_t> begun, all(100);
  std::iota(all.begin(), all.end(), std::size_t{0});
  parallel_for(
      all.size(), [&](std::size_t k) { begun.push_back(k); }, 1);
  EXPECT_EQ(begun, all);
}

TEST(ParallelFor, TakesAsManyThreadsAsAsked) {
  for (const int threads : {1, 2, 3}) {
    std::atomic<int> inside{0}, most{0};
    const auto wait_for_others = [&](std::size_t) {
      for (int now = ++inside, seen = most; seen < now && !most.compare_exchange_weak(seen, now);) {
      }
      for (int turn = 0; turn < 1000 && most < threads; ++turn)
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      --inside;
    };
    on_threads(3, [&] { parallel_for(12, wait_for_others, threads); });
    EXPECT_EQ(most, threads);
  }
}

TEST(ParallelFor, ThrowsTheFirstExceptionAndBeginsNoMore) {
  for (const int threads : {1, 3}) {
    std::atomic<int> begun{0};
    const auto fail = [&](std::size_t k) {
      ++begun;
      if (k >= 10) throw std::runtime_error("no " + std::to_string(k));
    };
    const auto loop = [&] { parallel_for(1000, fail, threads); };
    EXPECT_THROW(on_threads(3, loop), std::runtime_error);
    EXPECT_GE(begun, 11);
    EXPECT_LE(begun, 10 + threads);  // each had begun one more at most
  }
}

// A thread that waits for a loop within an iteration takes up no other iteration: what it holds there, others may want.
TEST(ParallelFor, WaitsWithinAnIterationWithoutBeginningAnother) {
  static thread_local bool inside = false;
  std::once_flag once;
  std::atomic<int> inner{0}, entered_twice{0};
  const auto outer = [&](std::size_t) {
    entered_twice += inside;
    inside = true;
    const auto loop = [&] { parallel_for(50, [&](std::size_t) { ++inner; }); };
    std::call_once(once, loop);
    loop();
    inside = false;
  };
  on_threads(4, [&] { parallel_for(200, outer); });
  EXPECT_EQ(entered_twice, 0);
  EXPECT_EQ(inner, 201 * 50);
}

}  // namespace parallel_test
}  // namespace bodyopt::testing
