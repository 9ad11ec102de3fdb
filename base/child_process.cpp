#include "base/child_process.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
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
  int status = 0;
  while (waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) fail("was lost");
  }
  if (WIFSIGNALED(status)) {
    const int signal = WTERMSIG(status);
    return {"", "signal " + std::to_string(signal) + " (" + strsignal(signal) + ")"};
  }
  switch (WEXITSTATUS(status)) {
    case kReturned:
      return {std::move(bytes), ""};
    case kThrew:
      return {"", std::move(bytes)};
    default:
      return {"", "exit code " + std::to_string(WEXITSTATUS(status))};
  }
}

}  // namespace bodyopt
