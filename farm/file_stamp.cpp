#include "farm/file_stamp.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include <cerrno>
#include <cstring>
#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "assets/json_file.h"
#include "runtime/core/error.h"
#include "runtime/core/hexadecimal.h"

namespace bodyopt {
namespace {

namespace fs = std::filesystem;

struct FileTimes {
  bool is_file = false;
  std::uint64_t bytes = 0;
  std::int64_t modified = 0;
};

FileTimes times_of(const fs::path& path) {
  struct stat status {};
  if (stat(path.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) return {};
  return {true, static_cast<std::uint64_t>(status.st_size),
          std::int64_t{status.st_mtim.tv_sec} * 1'000'000'000 + status.st_mtim.tv_nsec};
}

[[noreturn]] void fail(const fs::path& path, const std::string& reason) {
  throw Error(ErrorKind::file, path, ": cannot be read: ", reason,
              " (was it removed, or the folder it is in taken away?)");
}

std::uint64_t hash_of_content(const fs::path& path) {
  const int file = open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);  // a pipe must not block
  if (file < 0) fail(path, std::strerror(errno));
  const std::unique_ptr<XXH3_state_t, XXH_errorcode (*)(XXH3_state_t*)> state(XXH3_createState(), XXH3_freeState);
  XXH3_64bits_reset(state.get());
  std::vector<char> buffer(1 << 20);
  ssize_t got = 0;
  while ((got = read(file, buffer.data(), buffer.size())) > 0) {
    XXH3_64bits_update(state.get(), buffer.data(), static_cast<std::size_t>(got));
  }
  const int reason = errno;
  close(file);
  if (got < 0) fail(path, std::strerror(reason));
  return XXH3_64bits_digest(state.get());
}

}  // namespace

FileStamp stamp_file(const fs::path& path) {
  const FileTimes times = times_of(path);
  if (!times.is_file) fail(path, fs::exists(path) ? "it is no file" : "it is not there");
  return {path.string(), times.bytes, times.modified, hash_of_content(path)};
}

bool is_unchanged(const FileStamp& stamp, bool read_all) {
  const FileTimes times = times_of(stamp.path);
  if (!times.is_file || times.bytes != stamp.bytes) return false;
  if (times.modified == stamp.modified && !read_all) return true;
  try {
    return hash_of_content(stamp.path) == stamp.hash;
  } catch (const Error&) {
    return false;
  }
}

Json to_json(const FileStamp& stamp) {
  return {{"path", stamp.path},
          {"bytes", stamp.bytes},
          {"modified", std::to_string(stamp.modified)},
          {"hash", hexadecimal(stamp.hash)}};
}

FileStamp file_stamp(const JsonObject& object) {
  object.allow({"path", "bytes", "modified", "hash"});
  FileStamp stamp;
  stamp.path = object.name("path");
  stamp.bytes = static_cast<std::uint64_t>(object.number("bytes", 0, 9e15));
  stamp.modified = std::strtoll(object.text("modified").c_str(), nullptr, 10);
  stamp.hash = object.hash("hash");
  return stamp;
}

}  // namespace bodyopt
