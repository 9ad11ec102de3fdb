#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace bodyopt::viewport {

// The files that the viewport opened and saved last, in a folder of the user's.
class RecentFiles {
 public:
  static constexpr std::size_t kMost = 10;

  // An empty folder: none are known.
  explicit RecentFiles(std::filesystem::path folder) : folder_(std::move(folder)) {}

  std::vector<std::string> list() const;         // the last first
  void remember(const std::string& file) const;  // throws Error(file)

 private:
  std::filesystem::path folder_;
};

}  // namespace bodyopt::viewport
