#include "runtime/core/file_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <sstream>
#include <thread>
#include <utility>

#include "runtime/core/atomic_file.h"
#include "runtime/core/error.h"

namespace bodyopt {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

[[noreturn]] void fail(const fs::path& path, const std::string& doing, const char* cause) {
  throw Error(ErrorKind::file, path, ": ", doing, ": ", std::strerror(errno), " (", cause, ")");
}

int open_lock(const fs::path& path) {
  constexpr int kHow = O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC;
  int file = open(path.c_str(), O_RDWR | O_CREAT | kHow, 0666);
  if (file < 0 && errno == EACCES)
    file = open(path.c_str(), O_RDONLY | kHow);  // another user's: local locks need no more
  if (file < 0) {
    fail(path, "cannot be created", "is the folder there, writable, with space left, and no link of that name?");
  }
  struct stat status {};
  if (fstat(file, &status) != 0 || !S_ISREG(status.st_mode)) {
    close(file);
    throw Error(ErrorKind::file, path, ": is no file, and locks are files of their own: remove it");
  }
  return file;
}

// False: another holds it.
bool locked(int file, const fs::path& path) {
  while (flock(file, LOCK_EX | LOCK_NB) != 0) {
    if (errno == EWOULDBLOCK) return false;
    if (errno == EINTR) continue;
    const int reason = errno;
    close(file);
    errno = reason;
    fail(path, "cannot be locked, and without a lock another process may undo what is written",
         "does the file system give locks?");
  }
  return true;
}

// Whoever held the lock may have removed the file between its being opened and locked here.
bool is_at(int file, const fs::path& path) {
  struct stat held {
  }, there{};
  return fstat(file, &held) == 0 && lstat(path.c_str(), &there) == 0 && held.st_ino == there.st_ino &&
         held.st_dev == there.st_dev;
}

fs::path lock_beside(const fs::path& file) {
  const fs::path target = link_target(file);
  return target.parent_path() / ("." + target.filename().string() + ".lock");
}

}  // namespace

FileLock::FileLock(fs::path lock) : path_(std::move(lock)) {
  while (!take()) {
  }
}

FileLock::FileLock(FileLock&& other) noexcept : path_(std::move(other.path_)), file_(std::exchange(other.file_, -1)) {}

FileLock::~FileLock() {
  if (file_ >= 0) close(file_);
}

// False: to be tried again.
bool FileLock::take() {
  const int file = open_lock(path_);
  const bool held = locked(file, path_);
  if (held && is_at(file, path_)) {
    file_ = file;
    return true;
  }
  close(file);
  return !held;
}

void FileLock::remove_file() const { unlink(path_.c_str()); }

RunLock::RunLock(const fs::path& lock, const std::string& why) : lock_(lock) {
  if (!lock_.is_held()) throw Error(ErrorKind::file, lock, ": another run is ", why);
}

RunLock::~RunLock() { lock_.remove_file(); }

FileLock lock_to_change(const fs::path& file, std::chrono::milliseconds patience) {
  const fs::path path = lock_beside(file);
  const auto start = std::chrono::steady_clock::now();
  for (;;) {
    FileLock lock(path);
    if (lock.is_held()) return lock;
    if (std::chrono::steady_clock::now() - start > patience) {
      std::ostringstream text;
      text << file.string() << ": another process has been changing it for "
           << std::chrono::duration<double>(patience).count() << " seconds and holds " << path.string()
           << ": does it hang? Try again once it has ended";
      throw Error(ErrorKind::file, text.str());
    }
    std::this_thread::sleep_for(5ms);
  }
}

}  // namespace bodyopt
