#include "trainer/simulate/take_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "runtime/basis/error.h"

namespace bodyopt {
namespace {

int open_lock(const std::filesystem::path& path) {
  const int file = open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (file >= 0) return file;
  throw Error(ErrorKind::file, path.string() + ": cannot be created: " + std::strerror(errno) +
                                   " (is the folder there, writable, with space left?)");
}

bool held_by_another(int file) { return flock(file, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK; }

}  // namespace

TakeLock::TakeLock(std::filesystem::path cache) : cache_(std::move(cache)), path_(cache_) {
  path_.replace_extension(".lock");
  do {
    if (file_ >= 0) close(file_);
    file_ = open_lock(path_);
    if (held_by_another(file_)) {
      close(file_);
      throw Error(ErrorKind::file, path_.string() +
                                       ": another run is writing this take right now, and two would mix up its "
                                       "frames: wait for it to end, or give this one another --name");
    }
  } while (!is_at_its_path());
}

TakeLock::~TakeLock() {
  unlink(path_.c_str());  // while it is held: afterwards the path may be another run's
  close(file_);
}

// The run that held the lock may have removed the file between its being opened and locked here.
bool TakeLock::is_at_its_path() const {
  struct stat locked {
  }, there{};
  return fstat(file_, &locked) == 0 && stat(path_.c_str(), &there) == 0 && locked.st_ino == there.st_ino &&
         locked.st_dev == there.st_dev;
}

}  // namespace bodyopt
