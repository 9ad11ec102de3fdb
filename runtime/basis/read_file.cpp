#include "runtime/basis/read_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "runtime/core/error.h"
#include "runtime/core/file_problem.h"

namespace bodyopt {
namespace {

constexpr std::size_t kAtOnce = std::size_t{1} << 20;  // bytes

struct Closing {
  int file;
  ~Closing() {
    if (file >= 0) close(file);
  }
};

}  // namespace

std::string read_file(const std::filesystem::path& path, std::uint64_t most, const std::string& expected) {
  const auto refuse = [&](const auto&... what) { throw Error(ErrorKind::file, path, ": ", what...); };
  const Closing open_file{open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)};  // a pipe must not block
  struct stat status {};
  if (open_file.file < 0 || fstat(open_file.file, &status) != 0 || !S_ISREG(status.st_mode)) {
    refuse(why_unreadable(path));
  }
  std::string bytes;
  const auto refuse_size = [&](std::uint64_t size) {
    if (size <= most) return;
    refuse("has ", size, " bytes or more, expected ", most, " at most: not ", expected, "?");
  };
  const auto size = static_cast<std::uint64_t>(status.st_size);
  refuse_size(size);
  bytes.reserve(size);
  for (;;) {
    const std::size_t begin = bytes.size();
    bytes.resize(begin + std::clamp<std::size_t>(size > begin ? size - begin : 0, 1, kAtOnce));
    const ssize_t got = read(open_file.file, bytes.data() + begin, bytes.size() - begin);
    bytes.resize(begin + static_cast<std::size_t>(std::max<ssize_t>(got, 0)));
    if (got == 0) break;
    if (got < 0 && errno != EINTR) {
      refuse("cannot be read to its end: ", std::strerror(errno), ": a disk or network that fails?");
    }
    refuse_size(bytes.size());
  }
  if (bytes.size() < size) refuse("was cut off while it was read: is it being written?");
  return bytes;
}

}  // namespace bodyopt
