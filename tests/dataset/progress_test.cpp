#include "base/progress.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>

#include "runtime/core/error.h"
#include "tests/support/environment.h"

namespace bodyopt {
namespace {

// Not a terminal here: short work says one plain line at its end, without control characters.
TEST(Progress, ShortWorkSaysOneLineAtItsEnd) {
  ::testing::internal::CaptureStderr();
  {
    Progress progress("bake", 3);
    for (int k = 0; k < 3; ++k) progress.advance();
  }
  const std::string text = ::testing::internal::GetCapturedStderr();
  EXPECT_NE(text.find("bake: 100 % (3/3"), std::string::npos) << text;
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1) << text;
  EXPECT_EQ(text.find('\r'), std::string::npos);
}

// A program that runs any verb asks for it so; what it finds on standard error else is for people.
TEST(Progress, IsJsonWhereTheEnvironmentAsks) {
  for (const char* style : {"json", "lines"}) {
    const testing::Environment asked("BODYOPT_PROGRESS", style);
    ::testing::internal::CaptureStderr();
    {
      Progress progress("bake", 3);
      progress.advance(3);
    }
    const std::string text = ::testing::internal::GetCapturedStderr();
    EXPECT_EQ(text.starts_with("{\"progress\": \"bake\", \"done\": 3, \"total\": 3, \"seconds\": "),
              style == std::string("json"))
        << text;
  }
}

TEST(Progress, OfNothingSaysNothing) {
  ::testing::internal::CaptureStderr();
  { Progress progress("bake", 0); }
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

// In a process of its own, because the flag stays set.
TEST(Progress, AnInterruptEndsWorkAtTheNextStepWithExitCode75) {
  for (const int signal : {SIGINT, SIGTERM}) {
    const auto work = [signal] {
      catch_interrupts();
      if (interrupted()) std::exit(1);
      Progress progress("bake", 10);
      progress.advance(4);
      std::raise(signal);
      try {
        progress.advance();
      } catch (const Error& error) {
        std::exit(interrupted() ? error.exit_code() : 2);
      }
      std::exit(3);
    };
    EXPECT_EXIT(work(), ::testing::ExitedWithCode(75), "");
  }
}

}  // namespace
}  // namespace bodyopt
