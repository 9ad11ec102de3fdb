// Runs a verb of bodyopt in this process, which takes no time to start. What needs a process of its own, for its
// environment, its limits or its end, is for run_bodyopt() (run_program.h).
#pragma once

#include <sys/mman.h>
#include <unistd.h>
#include <wordexp.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "cli/run_command.h"
#include "tests/support/run_program.h"

namespace bodyopt {

// What this process prints goes here while the object lives.
class CapturedOutput {
 public:
  CapturedOutput() : file_(memfd_create("output", 0)) {
    if (file_ < 0) throw std::runtime_error("no file to print to");
    std::fflush(stdout);
    for (const int stream : {STDOUT_FILENO, STDERR_FILENO}) {
      before_[stream - 1] = dup(stream);
      dup2(file_, stream);
    }
  }
  ~CapturedOutput() {
    std::fflush(stdout);
    for (const int stream : {STDOUT_FILENO, STDERR_FILENO}) {
      dup2(before_[stream - 1], stream);
      close(before_[stream - 1]);
    }
    close(file_);
  }
  CapturedOutput(const CapturedOutput&) = delete;
  CapturedOutput& operator=(const CapturedOutput&) = delete;

  std::string text() const {
    std::fflush(stdout);
    std::string text(static_cast<std::size_t>(lseek(file_, 0, SEEK_END)), '\0');
    return pread(file_, text.data(), text.size(), 0) == static_cast<ssize_t>(text.size()) ? text : "";
  }

 private:
  int file_;
  std::array<int, 2> before_{};
};

// Where this process works while the object lives.
class WorkingFolder {
 public:
  explicit WorkingFolder(const std::filesystem::path& folder) { std::filesystem::current_path(folder); }
  ~WorkingFolder() { std::filesystem::current_path(before_); }
  WorkingFolder(const WorkingFolder&) = delete;
  WorkingFolder& operator=(const WorkingFolder&) = delete;

 private:
  std::filesystem::path before_ = std::filesystem::current_path();
};

// Words as the shell makes them of a command line: quotes taken off, names completed.
inline std::vector<std::string> shell_words(const std::string& line) {
  wordexp_t found{};
  if (wordexp(line.c_str(), &found, WRDE_NOCMD) != 0) throw std::invalid_argument("for a shell alone: " + line);
  const std::vector<std::string> words(found.we_wordv, found.we_wordv + found.we_wordc);
  wordfree(&found);
  return words;
}

// `arguments` as on a shell's command line after "bodyopt", without pipes and redirections.
inline ProgramResult run_verb(const std::string& arguments) {
  const CapturedOutput captured;
  [[maybe_unused]] static const bool prepared = (cli::prepare_process(), true);
  const int exit_code = cli::run_command(shell_words(arguments));
  return {exit_code, captured.text()};
}

}  // namespace bodyopt
