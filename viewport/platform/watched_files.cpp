#include "viewport/platform/watched_files.h"

#include <fstream>
#include <iterator>

namespace bodyopt::viewport {

namespace fs = std::filesystem;

namespace {

// Returns nothing of a file that cannot be read: who opens it says why.
std::string content_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace

WatchedFiles::WatchedFiles(const std::vector<fs::path>& files) {
  for (const fs::path& path : files) {
    const std::optional<Stamp> now = stamp(path);
    files_.push_back({path, now, now});
  }
}

std::vector<fs::path> WatchedFiles::changed(double now) {
  std::vector<fs::path> paths;
  for (File& file : files_) {
    const std::optional<Stamp> found = stamp(file.path);
    if (!found) file.known.reset();  // when it is back it counts, whatever it is like
    if (found != file.latest) {
      file.latest = found;
      file.since = now;
    }
    if (file.latest == file.known || now - file.since < kQuiet) continue;
    file.known = file.latest;
    paths.push_back(file.path);
  }
  return paths;
}

std::optional<WatchedFiles::Stamp> WatchedFiles::stamp(const fs::path& path) {
  std::error_code failure;
  if (!fs::is_regular_file(path, failure)) return {};
  const fs::file_time_type time = fs::last_write_time(path, failure);
  if (failure) return {};
  const std::uintmax_t size = fs::file_size(path, failure);
  if (failure) return {};
  return Stamp{time, size, size <= kSmall ? content_of(path) : ""};
}

}  // namespace bodyopt::viewport
