#include "base/child_process.h"

#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>

#include "runtime/core/error.h"
#include "tests/support/lowered_limit.h"

namespace bodyopt::trainer {
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

TEST(ChildProgram, ReadsWhatIsWrittenAndTellsHowItWent) {
  const std::vector<std::byte> bytes(300'000);
  ChildProgram counts({"sh", "-c", "test $(wc -c) = 600000 || { echo another size >&2; exit 3; }"});
  EXPECT_TRUE(counts.write(bytes));
  EXPECT_TRUE(counts.write(bytes));
  EXPECT_EQ(counts.finish(), "");
  ChildProgram fails({"sh", "-c", "cat > /dev/null; echo no room >&2; exit 3"});
  EXPECT_TRUE(fails.write(bytes));
  EXPECT_EQ(fails.finish(), "no room\n");
  ChildProgram silent({"sh", "-c", "exit 3"});
  EXPECT_EQ(silent.finish(), "exit code 3");
}

TEST(ChildProgram, OneThatEndsEarlyIsNoSignal) {
  const std::vector<std::byte> bytes(10'000'000);
  ChildProgram ended({"sh", "-c", "kill -9 $$"});
  EXPECT_FALSE(ended.write(bytes));
  EXPECT_EQ(ended.finish(), "signal 9 (Killed)");
  const auto begun = std::chrono::steady_clock::now();
  { const ChildProgram dropped({"sleep", "60"}); }
  EXPECT_LT(std::chrono::steady_clock::now() - begun, std::chrono::seconds(30)) << "it is killed";
}

TEST(ChildProgram, OneThatIsNotThereIsNamed) {
  try {
    ChildProgram({"no-such-program"});
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::usage);
    EXPECT_NE(std::string(error.what()).find("no-such-program"), std::string::npos);
  }
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
}  // namespace bodyopt::trainer
