#include "runtime/core/atomic_file.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstring>
#include <mutex>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "runtime/core/error.h"
#include "runtime/core/text.h"

namespace bodyopt {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kPrefix = ".bodyopt.", kSuffix = ".tmp";

std::string host_name() {
  char name[256] = {};
  return gethostname(name, sizeof(name) - 1) == 0 ? name : "";
}

std::string random_word() {
  std::uint64_t word = 0;
  if (getrandom(&word, sizeof(word), GRND_NONBLOCK) != static_cast<ssize_t>(sizeof(word))) {
    word = static_cast<std::uint64_t>(std::chrono::steady_clock::now().time_since_epoch().count());
  }
  return hexadecimal(word);
}

// `.bodyopt.HOST.PROCESS.RANDOM.tmp` of this host and a process that is no more.
bool is_orphan(const std::string& name) {
  if (!name.starts_with(kPrefix) || !name.ends_with(kSuffix)) return false;
  const std::string own = std::string(kPrefix) + host_name() + '.';
  if (!name.starts_with(own)) return false;
  pid_t process = 0;
  const char *begin = name.data() + own.size(), *end = name.data() + name.size();
  const auto [stop, failure] = std::from_chars(begin, end, process);
  return failure == std::errc() && stop != end && *stop == '.' && process > 0 && kill(process, 0) != 0 &&
         errno == ESRCH;
}

// Whoever writes a temporary file has it locked: a process that this one does not see (of another container) lives.
void remove_unlocked(const fs::path& path) {
  const int file = open(path.c_str(), O_RDWR | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  if (file < 0) return;
  if (flock(file, LOCK_EX | LOCK_NB) == 0) unlink(path.c_str());
  close(file);
}

// Removes the temporary files of killed processes, when this process first writes into the folder.
void clear_orphans(const fs::path& folder) {
  static std::mutex mutex;
  static std::set<fs::path> cleared;
  const std::lock_guard<std::mutex> lock(mutex);
  if (!cleared.insert(folder).second) return;
  std::error_code ignored;
  for (fs::directory_iterator entry(folder, ignored), end; !ignored && entry != end; entry.increment(ignored)) {
    if (is_orphan(entry->path().filename().string())) remove_unlocked(entry->path());
  }
}

// A new file in the folder of `path`, under a name that nobody else has. Gives -1 and leaves errno on failure.
int create_temporary(const fs::path& path, fs::path& temporary) {
  const fs::path folder = path.parent_path().empty() ? "." : path.parent_path();
  clear_orphans(folder);
  for (;;) {
    temporary = folder / (std::string(kPrefix) + host_name() + '.' + std::to_string(getpid()) + '.' + random_word() +
                          std::string(kSuffix));
    const int file = open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
    if (file >= 0) flock(file, LOCK_EX | LOCK_NB);  // where there are no locks, the process' number has to do
    if (file >= 0 || errno != EEXIST) return file;
  }
}

// The rename itself reaches the disk with its folder. Best effort: not every file system can do it.
void sync_folder(const fs::path& folder) {
  const int file = open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (file < 0) return;
  fsync(file);
  close(file);
}

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

fs::path link_target(const fs::path& path) {
  constexpr int kMostLinks = 40;  // one to the next, as the system follows them
  std::error_code failure;
  fs::path target = path;
  // One by one: weakly_canonical() leaves a link whose target does not exist yet as it is.
  for (int links = 0; fs::is_symlink(fs::symlink_status(target, failure)); ++links) {
    const fs::path next = fs::read_symlink(target, failure);
    if (failure || links == kMostLinks) {
      throw Error(ErrorKind::file, path, ": is a symbolic link that cannot be followed: does it lead back to itself?");
    }
    target = target.parent_path() / next;
  }
  const fs::path whole = fs::weakly_canonical(target, failure);
  return failure ? target : whole;
}

AtomicFile::AtomicFile(const std::filesystem::path& path) : path_(link_target(path)) {
  require_replaceable();
  const int file = create_temporary(path_, temporary_);
  if (file < 0) fail("cannot be created");
  file_ = fdopen(file, "wb");
  if (file_ == nullptr) {
    close(file);
    std::remove(temporary_.c_str());
    fail("cannot be created");
  }
}

AtomicFile::~AtomicFile() {
  if (file_ == nullptr) return;
  std::fclose(file_);
  std::remove(temporary_.c_str());
}

// A rename replaces whatever stands there, but for folders.
void AtomicFile::require_replaceable() const {
  std::error_code ignored;
  const fs::file_status status = fs::status(path_, ignored);
  if (fs::is_directory(status) || !path_.has_filename()) {
    throw Error(ErrorKind::file, path_, ": cannot be written: it is a folder; expected the name of a file");
  }
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    throw Error(ErrorKind::file, path_,
                ": cannot be written: it is a device or a pipe, which a rename would replace; "
                "expected the name of a file");
  }
}

void AtomicFile::fail(const char* doing) const {
  const std::string reason = std::strerror(errno);
  throw Error(ErrorKind::file, path_, ": ", doing, ": ", reason,
              " (is the folder there and writable, and is the disk not full?)");
}

void AtomicFile::write(std::span<const std::byte> bytes) {
  if (!bytes.empty() && std::fwrite(bytes.data(), 1, bytes.size(), file_) != bytes.size()) fail("cannot be written");
}

void AtomicFile::restart() {
  std::rewind(file_);
  if (ftruncate(fileno(file_), 0) != 0) fail("cannot be written");
}

void AtomicFile::write_file(const std::filesystem::path& file) {
  const int source = open(file.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);  // a pipe must not block
  std::vector<std::byte> buffer(1 << 20);
  ssize_t got = source < 0 ? -1 : 0;
  while (source >= 0 && (got = read(source, buffer.data(), buffer.size())) > 0) {
    if (std::fwrite(buffer.data(), 1, static_cast<std::size_t>(got), file_) != static_cast<std::size_t>(got)) break;
  }
  const int reason = errno;
  if (source >= 0) close(source);
  errno = reason;
  if (got > 0) fail("cannot be written");
  if (got == 0) return;
  throw Error(ErrorKind::file, file, ": cannot be read: ", std::strerror(reason),
              " (was it removed, or its folder taken away?)");
}

void AtomicFile::write_unfinished(AtomicFile& other) {
  if (std::fflush(other.file_) != 0) other.fail("cannot be written");
  write_file(other.temporary_);
}

void AtomicFile::rename_to(const std::filesystem::path& path) {
  if (std::fflush(file_) != 0) fail("cannot be written");
  require_replaceable();  // it may have come since
  if (std::rename(temporary_.c_str(), path.c_str()) != 0) fail("cannot be renamed into place");
  std::fclose(file_);  // nothing is buffered any more
  file_ = nullptr;
}

void AtomicFile::flush_and_rename_to(const std::filesystem::path& path) {
  if (std::fflush(file_) != 0 || fsync(fileno(file_)) != 0) fail("cannot be written");
  rename_to(path);
  sync_folder(path.parent_path());
}

void AtomicFile::commit() { flush_and_rename_to(path_); }

void AtomicFile::commit_unflushed() { rename_to(path_); }

void AtomicFile::put_aside(const std::filesystem::path& path) {
  path_ = link_target(path);
  flush_and_rename_to(path_);
}

void write_file_atomically(const std::filesystem::path& path, std::span<const std::byte> bytes) {
  AtomicFile file(path);
  file.write(bytes);
  file.commit();
}

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
