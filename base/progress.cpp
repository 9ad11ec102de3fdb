#include "base/progress.h"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "runtime/core/error.h"
#include "runtime/core/text.h"

namespace bodyopt {
namespace {

std::atomic<bool> interrupt_received{false};
ProgressStyle chosen_style = ProgressStyle::automatic;

ProgressStyle style() {
  if (chosen_style != ProgressStyle::automatic) return chosen_style;
  const char* asked = std::getenv("BODYOPT_PROGRESS");  // of a program that runs verbs
  if (asked != nullptr && std::string_view(asked) == "json") return ProgressStyle::json;
  return isatty(STDERR_FILENO) ? ProgressStyle::bar : ProgressStyle::lines;
}

// Seconds from one line to the next at least.
double pause() {
  switch (style()) {
    case ProgressStyle::bar:
      return 0.1;
    case ProgressStyle::lines:
      return 5;
    default:
      return 1;
  }
}

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

void set_progress_style(ProgressStyle style) { chosen_style = style; }

bool interrupted() { return interrupt_received; }

Progress::Progress(std::string label, std::size_t total, std::string kept)
    : label_(std::move(label)), kept_(std::move(kept)), total_(total) {}

Progress::~Progress() {
  if (done_ > 0) print(true);
}

void Progress::advance(std::size_t steps) {
  const std::lock_guard<std::mutex> lock(mutex_);
  done_ += steps;
  if (printed_.seconds() > pause()) print(false);
  if (interrupted()) {
    throw Error(ErrorKind::interrupted, label_ + ": interrupted; " + kept_);
  }
}

void Progress::print(bool last) const {
  printed_ = {};
  std::FILE* out = style() == ProgressStyle::openjd ? stdout : stderr;
  std::fputs(line(started_.seconds(), last).c_str(), out);
  std::fflush(out);
}

std::string Progress::line(double seconds, bool last) const {
  const double share = total_ == 0 ? 1 : static_cast<double>(done_) / static_cast<double>(total_);
  const double left = share > 0 ? seconds * (1 - share) / share : 0;
  const std::string text = last ? formatted("%zu/%zu in %.1f s", done_, total_, seconds)
                                : formatted("%zu/%zu, %.0f s left", done_, total_, left);
  switch (style()) {
    case ProgressStyle::bar: {
      constexpr std::size_t kWidth = 30;
      const std::size_t filled = std::min(kWidth, static_cast<std::size_t>(share * kWidth));
      const std::string bar = std::string(filled, '#') + std::string(kWidth - filled, '.');
      return formatted("\r%-12s [%s] %s\033[K%s", label_.c_str(), bar.c_str(), text.c_str(), last ? "\n" : "");
    }
    case ProgressStyle::json:
      return formatted("{\"progress\": \"%s\", \"done\": %zu, \"total\": %zu, \"seconds\": %.3f}\n", label_.c_str(),
                       done_, total_, seconds);
    case ProgressStyle::openjd:
      return formatted("openjd_progress: %.1f\nopenjd_status: %s %s\n", std::min(100.0, 100 * share), label_.c_str(),
                       text.c_str());
    default:
      return formatted("%s: %3.0f %% (%s)\n", label_.c_str(), 100 * share, text.c_str());
  }
}

}  // namespace bodyopt
