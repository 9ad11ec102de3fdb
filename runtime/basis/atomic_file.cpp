#include "runtime/basis/atomic_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <string>

#include "runtime/basis/error.h"

namespace bodyopt {
namespace {

namespace fs = std::filesystem;

// A symbolic link is followed, so that the file it names is replaced and not the link.
fs::path resolved(const fs::path& path) {
  std::error_code failure;
  const fs::path target = fs::weakly_canonical(path, failure);
  return failure ? path : target;
}

// A new file in the folder of `path`, under a name that nobody else has. Gives -1 and leaves errno on failure.
int create_temporary(const fs::path& path, fs::path& temporary) {
  static std::atomic<unsigned> count{0};
  for (;;) {
    temporary = path.parent_path() / (".bodyopt." + std::to_string(getpid()) + "." + std::to_string(count++) + ".tmp");
    const int file = open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
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

}  // namespace

AtomicFile::AtomicFile(const std::filesystem::path& path) : path_(resolved(path)) {
  std::error_code ignored;
  const fs::file_status status = fs::status(path_, ignored);
  if (fs::is_directory(status) || !path_.has_filename()) {
    throw Error(ErrorKind::file, path_.string() + ": cannot be written: it is a folder; expected the name of a file");
  }
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    throw Error(ErrorKind::file, path_.string() +
                                     ": cannot be written: it is a device or a pipe, which a rename would replace; "
                                     "expected the name of a file");
  }
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

void AtomicFile::fail(const char* doing) const {
  const std::string reason = std::strerror(errno);
  throw Error(ErrorKind::file, path_.string() + ": " + doing + ": " + reason +
                                   " (is the folder there and writable, and is the disk not full?)");
}

void AtomicFile::write(std::span<const std::byte> bytes) {
  if (!bytes.empty() && std::fwrite(bytes.data(), 1, bytes.size(), file_) != bytes.size()) fail("cannot be written");
}

void AtomicFile::commit() {
  if (std::fflush(file_) != 0 || fsync(fileno(file_)) != 0) fail("cannot be written");
  if (std::rename(temporary_.c_str(), path_.c_str()) != 0) fail("cannot be renamed into place");
  std::fclose(file_);  // nothing is buffered any more
  file_ = nullptr;
  sync_folder(path_.parent_path());
}

void write_file_atomically(const std::filesystem::path& path, std::span<const std::byte> bytes) {
  AtomicFile file(path);
  file.write(bytes);
  file.commit();
}

}  // namespace bodyopt
