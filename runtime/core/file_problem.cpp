#include "runtime/core/file_problem.h"

#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>

#include "runtime/core/error.h"

namespace bodyopt {
namespace {

namespace fs = std::filesystem;

std::error_code system_error(int number) { return {number, std::generic_category()}; }

const char* likely_cause(const std::error_code& failure) {
  switch (failure.value()) {
    case EACCES:
    case EPERM:
      return "no permission for it, or for a folder above it";
    case ELOOP:
      return "does a symbolic link lead back to itself?";
    case ENAMETOOLONG:
      return "names have 255 bytes at most, whole paths 4,095";
    case ENOENT:
      return "is a folder above it missing?";
    case ENOTDIR:
    case EEXIST:
      return "is a file in the place of a folder?";
    case EROFS:
      return "is it mounted for reading alone?";
    case ENOSPC:
    case EDQUOT:
      return "is the disk full?";
    default:
      return nullptr;
  }
}

}  // namespace

std::string with_cause(std::error_code failure) {
  const char* cause = likely_cause(failure);
  return failure.message() + (cause != nullptr ? concat(" (", cause, ")") : "");
}

std::string describe_refusal(const fs::filesystem_error& error) {
  std::string named = error.path1().empty() ? "the current folder" : error.path1().string();
  if (!error.path2().empty()) named += concat(", ", error.path2());
  return concat(named, ": the file system refuses it: ", with_cause(error.code()));
}

std::string why_unreadable(const fs::path& path) {
  const int failure = errno;
  struct stat status {};
  if (stat(path.c_str(), &status) != 0) {
    if (errno != ENOENT) return "cannot be read: " + with_cause(system_error(errno));
    const bool is_link = lstat(path.c_str(), &status) == 0;
    return is_link ? "is a symbolic link to a file that is not there" : "no such file";
  }
  switch (status.st_mode & S_IFMT) {
    case S_IFREG:
      break;
    case S_IFDIR:
      return "is a folder; expected a file";
    case S_IFIFO:
      return "is a pipe; expected a file";
    case S_IFSOCK:
      return "is a socket; expected a file";
    default:
      return "is a device; expected a file";
  }
  return "cannot be read: " + with_cause(system_error(access(path.c_str(), R_OK) != 0 ? errno : failure));
}

void require_file(const fs::path& path) {
  std::error_code ignored;
  if (!fs::is_regular_file(path, ignored)) throw Error(ErrorKind::file, path, ": ", why_unreadable(path));
}

}  // namespace bodyopt
