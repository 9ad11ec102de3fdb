#include "base/child_process.h"

#include <gtest/gtest.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>

#include "tests/support/lowered_limit.h"

namespace bodyopt {
namespace {

TEST(ChildProcess, HandsOverWhatTheWorkReturned) {
  std::string bytes(3 << 20, '\0');  // more than a pipe holds
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<char>(i * 7);
  const ChildResult result = run_in_child([&] { return bytes; });
  EXPECT_EQ(result.crash, "");
  EXPECT_TRUE(result.bytes == bytes);
}

TEST(ChildProcess, LeavesTheParentAsItWas) {
  int value = 1;
  (void)run_in_child([&] {
    value = 2;
    return std::string();
  });
  EXPECT_EQ(value, 1);
}

TEST(ChildProcess, NamesACrash) {
  const ChildResult signal = run_in_child([]() -> std::string { std::raise(SIGSEGV), std::abort(); });
  EXPECT_EQ(signal.crash, "signal 11 (Segmentation fault)");
  const ChildResult thrown = run_in_child([]() -> std::string { throw std::runtime_error("no volume"); });
  EXPECT_EQ(thrown.crash, "no volume");
  const ChildResult ended = run_in_child([]() -> std::string { std::_Exit(7); });
  EXPECT_EQ(ended.crash, "exit code 7");
}

TEST(ChildProcess, ALimitOfFilesIsNoneOfResults) {
  const LoweredLimit limit(RLIMIT_FSIZE, 1000);
  const ChildResult result = run_in_child([] { return std::string(100'000, 'x'); });
  EXPECT_EQ(result.crash, "");
  EXPECT_EQ(result.bytes.size(), 100'000u);
}

TEST(ChildProcess, LeavesInterruptionsToItsParent) {
  const ChildResult result = run_in_child([] {
    std::raise(SIGINT);
    std::raise(SIGTERM);
    return std::string("went on");
  });
  EXPECT_EQ(result.bytes, "went on");
}

TEST(ChildProcess, PrintsNothing) {
  ::testing::internal::CaptureStdout();
  (void)run_in_child([] {
    std::puts("from a library");
    std::fflush(stdout);
    return std::string();
  });
  EXPECT_EQ(::testing::internal::GetCapturedStdout(), "");
}

}  // namespace
}  // namespace bodyopt
