// Progress of long work, and its interruption: a bar on a terminal, plain lines otherwise, always on standard error.
#pragma once

#include <chrono>
#include <cstddef>
#include <string>

namespace bodyopt {

class Progress {
 public:
  Progress(std::string label, std::size_t total);
  ~Progress();
  // Call from one thread (or inside a critical section). Throws Error(interrupted) once SIGINT or SIGTERM was received.
  void advance(std::size_t steps = 1);

 private:
  void print(bool last) const;
  std::string label_;
  std::size_t total_, done_ = 0;
  std::chrono::steady_clock::time_point start_;
  mutable std::chrono::steady_clock::time_point printed_;
};

// From the first call on, SIGINT and SIGTERM set a flag instead of killing the program.
void catch_interrupts();
bool interrupted();

}  // namespace bodyopt
