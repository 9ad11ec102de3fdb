#include "base/progress.h"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdio>

#include "runtime/core/error.h"

namespace bodyopt {
namespace {

using Clock = std::chrono::steady_clock;

std::atomic<bool> interrupt_received{false};

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

}  // namespace

void catch_interrupts() {
  struct sigaction action = {};
  action.sa_handler = [](int) {
    interrupt_received = true;
    constexpr char kText[] = "\nstopping once what is in hand is done, which may take minutes; once more to stop now\n";
    if (write(STDERR_FILENO, kText, sizeof(kText) - 1) < 0) return;  // nobody to tell
  };
  // A second signal ends the program at once; system calls go on after the first.
  action.sa_flags = static_cast<int>(SA_RESETHAND | SA_RESTART);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

bool interrupted() { return interrupt_received; }

Progress::Progress(std::string label, std::size_t total, std::string kept)
    : label_(std::move(label)), kept_(std::move(kept)), total_(total), start_(Clock::now()), printed_(start_) {}

Progress::~Progress() {
  if (done_ > 0) print(true);
}

void Progress::advance(std::size_t steps) {
  const std::lock_guard<std::mutex> lock(mutex_);
  done_ += steps;
  const double pause = isatty(STDERR_FILENO) ? 0.1 : 5.0;
  if (seconds_since(printed_) > pause) print(false);
  if (interrupted()) {
    throw Error(ErrorKind::interrupted, label_ + ": interrupted; " + kept_);
  }
}

void Progress::print(bool last) const {
  printed_ = Clock::now();
  const double elapsed = seconds_since(start_);
  const double share = total_ == 0 ? 1 : static_cast<double>(done_) / static_cast<double>(total_);
  char text[200];
  if (last) {
    std::snprintf(text, sizeof(text), "%zu/%zu in %.1f s", done_, total_, elapsed);
  } else {
    const double left = share > 0 ? elapsed * (1 - share) / share : 0;
    std::snprintf(text, sizeof(text), "%zu/%zu, %.0f s left", done_, total_, left);
  }
  if (isatty(STDERR_FILENO)) {
    constexpr int kWidth = 30;
    const int filled = std::clamp(static_cast<int>(share * kWidth), 0, kWidth);
    std::fprintf(stderr, "\r%-12s [%s%s] %s\033[K%s", label_.c_str(),
                 std::string(static_cast<std::size_t>(filled), '#').c_str(),
                 std::string(static_cast<std::size_t>(kWidth - filled), '.').c_str(), text, last ? "\n" : "");
  } else {
    std::fprintf(stderr, "%s: %3.0f %% (%s)\n", label_.c_str(), 100 * share, text);
  }
  std::fflush(stderr);
}

}  // namespace bodyopt
