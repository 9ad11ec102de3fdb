#include "farm/run_command.h"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstring>

#include "runtime/core/error.h"
#include "runtime/core/stopwatch.h"

extern char** environ;

namespace bodyopt {
namespace {

constexpr std::size_t kMostOutput = 64 << 20;

}  // namespace

CommandResult run_command(const std::vector<std::string>& words, double seconds) {
  const auto fail = [&](const auto&... what) { throw Error(ErrorKind::device, "'", words.front(), "' ", what...); };
  std::vector<char*> pointers;
  for (const std::string& word : words) pointers.push_back(const_cast<char*>(word.c_str()));
  pointers.push_back(nullptr);
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) fail("cannot be started: ", std::strerror(errno));
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDERR_FILENO);
  pid_t process = -1;
  const int failure = posix_spawnp(&process, pointers[0], &actions, nullptr, pointers.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[1]);
  if (failure != 0) {
    close(ends[0]);
    fail("cannot be started: ", std::strerror(failure), " (is it installed?)");
  }
  CommandResult result;
  bool is_late = false;
  const Stopwatch watch;
  char buffer[65536];
  for (;;) {
    const double left = seconds - watch.seconds();
    pollfd ready{ends[0], POLLIN, 0};
    is_late = left <= 0 || poll(&ready, 1, static_cast<int>(1e3 * left) + 1) == 0;
    if (is_late || result.output.size() > kMostOutput) break;
    const ssize_t got = read(ends[0], buffer, sizeof(buffer));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) break;
    result.output.append(buffer, static_cast<std::size_t>(got));
  }
  close(ends[0]);
  if (is_late) kill(process, SIGKILL);
  int status = 0;
  while (waitpid(process, &status, 0) < 0 && errno == EINTR) {
  }
  if (is_late) fail("gave no answer in ", static_cast<int>(seconds), " s");
  result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return result;
}

}  // namespace bodyopt
