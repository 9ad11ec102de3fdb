#include "base/child_process.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <iostream>

#include "runtime/core/error.h"

namespace bodyopt {
namespace {

constexpr int kReturned = 0, kThrew = 1, kNotWritten = 2;

[[noreturn]] void fail(const char* what) {
  throw Error(ErrorKind::device, std::string("a child process ") + what + ": " + std::strerror(errno) +
                                     "; the likely cause is a limit of memory or of processes");
}

// Where the child leaves its bytes: memory without a name, read by the parent when the child has ended.
class SharedMemory {
 public:
  SharedMemory() : file_(memfd_create("child", MFD_CLOEXEC)) {
    if (file_ < 0) fail("has no memory to leave its result in");
  }
  ~SharedMemory() { close(file_); }
  SharedMemory(const SharedMemory&) = delete;
  SharedMemory& operator=(const SharedMemory&) = delete;

  bool write(const std::string& bytes) const {
    for (std::size_t done = 0; done < bytes.size();) {
      const ssize_t wrote = ::write(file_, bytes.data() + done, bytes.size() - done);
      if (wrote <= 0) return false;
      done += static_cast<std::size_t>(wrote);
    }
    return true;
  }
  std::string read() const {
    struct stat status {};
    fstat(file_, &status);
    std::string bytes(static_cast<std::size_t>(status.st_size), '\0');
    for (std::size_t done = 0; done < bytes.size();) {
      const ssize_t got = pread(file_, bytes.data() + done, bytes.size() - done, static_cast<off_t>(done));
      if (got <= 0) fail("left a result that cannot be read");
      done += static_cast<std::size_t>(got);
    }
    return bytes;
  }

 private:
  int file_;
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

[[noreturn]] void be_the_child(const std::function<std::string()>& work, pid_t parent, const SharedMemory& result) {
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
  const SharedMemory result;
  std::cout.flush();  // or the child would print it again
  std::cerr.flush();
  std::fflush(nullptr);
  const pid_t parent = getpid(), child = fork();
  if (child < 0) fail("cannot be made");
  if (child == 0) be_the_child(work, parent, result);
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
      return {result.read(), ""};
    case kThrew:
      return {"", result.read()};
    default:
      return {"", "exit code " + std::to_string(WEXITSTATUS(status))};
  }
}

}  // namespace bodyopt
