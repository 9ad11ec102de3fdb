// Runs a program and gives what it printed and how it ended.
#pragma once

#include <sys/wait.h>

#include <cstdio>
#include <string>

#include "tests/support/paths.h"

namespace bodyopt {

struct ProgramResult {
  int exit_code = -1;
  std::string output;  // standard output and error

  std::size_t count(const std::string& said) const {
    std::size_t times = 0;
    for (std::size_t at = 0; (at = output.find(said, at)) != std::string::npos; ++at) ++times;
    return times;
  }
};

// `command` is a shell command line.
inline ProgramResult run_program(const std::string& command) {
  ProgramResult result;
  FILE* pipe = popen((command + " 2>&1").c_str(), "r");
  if (pipe == nullptr) return result;
  char buffer[4096];
  for (std::size_t n; (n = fread(buffer, 1, sizeof(buffer), pipe)) > 0;) result.output.append(buffer, n);
  const int status = pclose(pipe);
  result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128;
  return result;
}

// bodyopt with these arguments.
inline ProgramResult run_bodyopt(const std::string& arguments) { return run_program(kProgram + " " + arguments); }

}  // namespace bodyopt
