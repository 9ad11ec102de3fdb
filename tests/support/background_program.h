// A program that runs beside the test.
#pragma once

#include <fcntl.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <thread>

#include "tests/support/read_bytes.h"

namespace bodyopt {

// Asks until it is so; false when it is not in time.
inline bool comes_true(const std::function<bool()>& condition, double seconds) {
  const auto start = std::chrono::steady_clock::now();
  while (!condition()) {
    if (std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() > seconds) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return true;
}

class BackgroundProgram {
 public:
  // `command` is a shell command line; what it prints goes to a file.
  BackgroundProgram(const std::string& command, const std::filesystem::path& output) : output_(output) {
    const std::string line = "exec " + command;
    process_ = fork();
    if (process_ != 0) return;
    const int file = open(output.c_str(), O_CREAT | O_TRUNC | O_WRONLY, 0600);
    dup2(file, STDOUT_FILENO);
    dup2(file, STDERR_FILENO);
    ::signal(SIGINT, SIG_DFL);  // which shells ignore for what runs in their background
    execl("/bin/sh", "sh", "-c", line.c_str(), nullptr);
    _exit(127);
  }
  ~BackgroundProgram() {
    if (exit_code_) return;
    kill(process_, SIGKILL);
    waitpid(process_, nullptr, 0);
  }
  BackgroundProgram(const BackgroundProgram&) = delete;
  BackgroundProgram& operator=(const BackgroundProgram&) = delete;

  void send(int signal) const { kill(process_, signal); }
  bool runs() { return !ended(); }
  // 128 + n: ended by signal n; nothing: it still runs.
  std::optional<int> wait(double seconds) {
    comes_true([this] { return ended(); }, seconds);
    return exit_code_;
  }
  std::string output() const { return testing::read_bytes(output_); }

 private:
  bool ended() {
    int status = 0;
    if (!exit_code_ && waitpid(process_, &status, WNOHANG) == process_) {
      exit_code_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    }
    return exit_code_.has_value();
  }

  std::filesystem::path output_;
  pid_t process_ = -1;
  std::optional<int> exit_code_;
};

}  // namespace bodyopt
