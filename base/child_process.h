// Work of libraries that may crash: in a process of its own, which takes nobody along.
#pragma once

#include <functional>
#include <string>

namespace bodyopt {

struct ChildResult {
  std::string bytes;  // what the work returned
  std::string crash;  // "signal 11 (Segmentation fault)"; empty: it returned
};

// Forks: `work` sees the memory of this process and none of its threads, and may not ask for others. What it prints is
// dropped; interruptions are the parent's matter; it ends with its parent. An exception of `work` is a crash, named by
// its text. Throws Error(device) where there is no process to be had.
[[nodiscard]] ChildResult run_in_child(const std::function<std::string()>& work);

}  // namespace bodyopt
