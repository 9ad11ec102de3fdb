// Work of libraries that may crash: in a process of its own, which takes nobody along. And other programs.
#pragma once

#include <sys/types.h>

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace bodyopt {

struct ChildResult {
  std::string bytes;  // what the work returned
  std::string crash;  // "signal 11 (Segmentation fault)"; empty: it returned
};

// Forks: `work` sees the memory of this process and none of its threads, and may not ask for others. What it prints is
// dropped; interruptions are the parent's matter; it ends with its parent. An exception of `work` is a crash, named by
// its text. Throws Error(device) where there is no process to be had.
[[nodiscard]] ChildResult run_in_child(const std::function<std::string()>& work);

// Another program, which reads what is written to it. It is killed where it has not ended once this goes.
class ChildProgram {
 public:
  // The program's name, which is looked for on PATH, and its arguments. Throws Error(usage) where there is none, and
  // Error(device) where there is no process to be had.
  explicit ChildProgram(const std::vector<std::string>& command);
  ~ChildProgram();
  ChildProgram(const ChildProgram&) = delete;
  ChildProgram& operator=(const ChildProgram&) = delete;

  // False: it reads no more.
  [[nodiscard]] bool write(std::span<const std::byte> bytes);
  // Once it has ended, why it failed, as it said on standard error; empty: it did not.
  [[nodiscard]] std::string finish();

 private:
  int input_ = -1, errors_ = -1;
  pid_t process_ = -1;
};

}  // namespace bodyopt
