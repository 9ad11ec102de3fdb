// Progress of long work, and its interruption: a bar on a terminal, plain lines otherwise, on standard error; or as
// programs read it.
#pragma once

#include <cstddef>
#include <mutex>
#include <string>

#include "runtime/core/stopwatch.h"

namespace bodyopt {

enum class ProgressStyle {
  automatic,  // json where BODYOPT_PROGRESS says so, a bar on a terminal, else lines
  bar,
  lines,
  json,    // a line of JSON on standard error: {"progress": what, "done": n, "total": n, "seconds": s}
  openjd,  // "openjd_progress: per cent" and "openjd_status: what" on standard output, as Open Job Description says
};
// Applies to all progress from now on.
void set_progress_style(ProgressStyle style);

class [[nodiscard]] Progress {
 public:
  // kept: what is left of the work when it is interrupted, for the message.
  Progress(std::string label, std::size_t total, std::string kept = "nothing of it is kept");
  ~Progress();
  // Any thread may call it. Throws Error(interrupted) once SIGINT or SIGTERM was received.
  void advance(std::size_t steps = 1);

 private:
  void print(bool last) const;
  std::string line(double seconds, bool last) const;
  std::string label_, kept_;
  std::size_t total_, done_ = 0;
  Stopwatch started_;
  mutable Stopwatch printed_;
  std::mutex mutex_;
};

// Makes the first SIGINT and the first SIGTERM set a flag. A second one of the same kind kills the program.
void catch_interrupts();
[[nodiscard]] bool interrupted();

}  // namespace bodyopt
