// Other programs, run without a shell: nothing in an argument has a meaning.
#pragma once

#include <string>
#include <vector>

namespace bodyopt {

struct CommandResult {
  int exit_code = -1;  // 128 + n: ended by signal n
  std::string output;  // standard output and error
};

// Waits for the program `words[0]`, found on the PATH; ends it after so many seconds. Throws Error(device) where it
// cannot be started, and where it took too long.
CommandResult run_command(const std::vector<std::string>& words, double seconds);

}  // namespace bodyopt
