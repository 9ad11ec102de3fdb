// Finds files that have changed on disk, for the viewport to read them again.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace bodyopt::viewport {

// Asks the file system each time (which works on network folders, too). A file has changed when its modification time
// or size is another, or when it was away and is back. Of a small one (kSmall) the content counts, too: a dataset may
// be edited twice within one tick of the file system's clock. It is reported after kQuiet without a change, so that
// nobody reads a file that is still being written.
class WatchedFiles {
 public:
  static constexpr double kQuiet = 0.3;                              // seconds
  static constexpr std::uintmax_t kSmall = std::uintmax_t{1} << 20;  // bytes

  // Compares files with what they are like now; a file that is not there is reported when it comes.
  explicit WatchedFiles(const std::vector<std::filesystem::path>& files);

  // The files that have changed since they were reported last, in the order given. `now`: seconds, rising.
  std::vector<std::filesystem::path> changed(double now);

 private:
  struct Stamp {
    std::filesystem::file_time_type time;
    std::uintmax_t size;
    std::string content;  // of a small file
    bool operator==(const Stamp&) const = default;
  };
  struct File {
    std::filesystem::path path;
    std::optional<Stamp> known, latest;  // as reported last, and as seen last; empty while it is away
    double since = 0;                    // when `latest` was seen first
  };

  static std::optional<Stamp> stamp(const std::filesystem::path& path);

  std::vector<File> files_;
};

}  // namespace bodyopt::viewport
