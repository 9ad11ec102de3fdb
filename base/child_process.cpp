#include "base/child_process.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <iostream>
#include <utility>

#include "runtime/core/error.h"

namespace bodyopt {
namespace {

constexpr int kReturned = 0, kThrew = 1, kNotWritten = 2;

[[noreturn]] void fail(const char* what) {
  throw Error(ErrorKind::device, std::string("a child process ") + what + ": " + std::strerror(errno) +
                                     "; the likely cause is a limit of memory or of processes");
}

// Pipe for the child's bytes. No limit of memory or of files is on it: they are read while they are written.
class Pipe {
 public:
  Pipe() {
    if (pipe2(ends_, O_CLOEXEC) != 0) fail("has nothing to hand its result over with");
  }
  ~Pipe() {
    close_end(0);
    close_end(1);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;

  bool write(const std::string& bytes) const {
    for (std::size_t done = 0; done < bytes.size();) {
      const ssize_t wrote = ::write(ends_[1], bytes.data() + done, bytes.size() - done);
      if (wrote <= 0) return false;
      done += static_cast<std::size_t>(wrote);
    }
    return true;
  }
  // Reads until the child has ended.
  std::string read() {
    close_end(1);
    std::string bytes;
    char some[1 << 16];
    for (;;) {
      const ssize_t got = ::read(ends_[0], some, sizeof(some));
      if (got < 0 && errno == EINTR) continue;
      if (got < 0) fail("left a result that cannot be read");
      if (got == 0) return bytes;
      bytes.append(some, static_cast<std::size_t>(got));
    }
  }

 private:
  void close_end(int end) {
    if (ends_[end] >= 0) close(ends_[end]);
    ends_[end] = -1;
  }

  int ends_[2] = {-1, -1};
};

int wait_for(pid_t child) {
  int status = 0;
  while (waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) fail("was lost");
  }
  return status;
}

std::string end_of(int status) {
  if (!WIFSIGNALED(status)) return "exit code " + std::to_string(WEXITSTATUS(status));
  const int signal = WTERMSIG(status);
  return "signal " + std::to_string(signal) + " (" + strsignal(signal) + ")";
}

void keep_to_itself(pid_t parent) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(kNotWritten);  // it died before the line above
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, SIG_IGN);
  for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT}) std::signal(signal, SIG_DFL);
  const rlimit none{0, 0};
  setrlimit(RLIMIT_CORE, &none);
  const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
  if (nowhere < 0) return;
  dup2(nowhere, STDOUT_FILENO);
  dup2(nowhere, STDERR_FILENO);
}

[[noreturn]] void be_the_child(const std::function<std::string()>& work, pid_t parent, const Pipe& result) {
  keep_to_itself(parent);
  int code = kThrew;
  std::string bytes;
  try {
    bytes = work();
    code = kReturned;
  } catch (const std::exception& error) {
    bytes = error.what();
  } catch (...) {
    bytes = "an exception that is not std::exception";
  }
  _exit(result.write(bytes) ? code : kNotWritten);
}

}  // namespace

ChildResult run_in_child(const std::function<std::string()>& work) {
  Pipe result;
  std::cout.flush();  // or the child would print it again
  std::cerr.flush();
  std::fflush(nullptr);
  const pid_t parent = getpid(), child = fork();
  if (child < 0) fail("cannot be made");
  if (child == 0) be_the_child(work, parent, result);
  std::string bytes = result.read();
  const int status = wait_for(child);
  const int code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  if (code == kReturned) return {std::move(bytes), ""};
  if (code == kThrew) return {"", std::move(bytes)};
  return {"", end_of(status)};
}

// A socket, as one that nobody reads any more ends no process that writes to it.
ChildProgram::ChildProgram(const std::vector<std::string>& command) {
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) fail("has nothing to read from");
  input_ = ends[0];
  errors_ = memfd_create("errors", MFD_CLOEXEC);
  std::vector<char*> words;
  for (const std::string& word : command) words.push_back(const_cast<char*>(word.c_str()));
  words.push_back(nullptr);
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_adddup2(&files, ends[1], STDIN_FILENO);
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_adddup2(&files, errors_, STDERR_FILENO);
  const int problem = posix_spawnp(&process_, words[0], &files, nullptr, words.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  close(ends[1]);
  if (problem == 0) return;
  close(input_);
  close(errors_);
  if (problem == ENOENT || problem == EACCES) throw Error(ErrorKind::usage, command.front() + " is no program on PATH");
  errno = problem;
  fail("cannot be made");
}

ChildProgram::~ChildProgram() {
  if (process_ > 0) {
    kill(process_, SIGKILL);
    int status = 0;
    while (waitpid(process_, &status, 0) < 0 && errno == EINTR) continue;
  }
  if (input_ >= 0) close(input_);
  close(errors_);
}

bool ChildProgram::write(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t wrote = send(input_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (wrote < 0 && errno == EINTR) continue;
    if (wrote <= 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(wrote));
  }
  return true;
}

std::string ChildProgram::finish() {
  if (process_ < 0) return "";
  close(std::exchange(input_, -1));
  const int status = wait_for(std::exchange(process_, -1));
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return "";
  char said[2000];
  const ssize_t size = pread(errors_, said, sizeof(said), 0);
  return size > 0 ? std::string(said, static_cast<std::size_t>(size)) : end_of(status);
}

}  // namespace bodyopt
