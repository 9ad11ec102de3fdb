#include "viewport/state/recent_files.h"

#include <algorithm>
#include <fstream>
#include <span>
#include <system_error>

#include "runtime/core/atomic_file.h"
#include "runtime/core/error.h"

namespace bodyopt::viewport {
namespace {

constexpr const char* kName = "recent.txt";

}  // namespace

std::vector<std::string> RecentFiles::list() const {
  std::vector<std::string> files;
  std::ifstream list(folder_ / kName);
  for (std::string line; !folder_.empty() && files.size() < kMost && std::getline(list, line);) {
    if (!line.empty()) files.push_back(line);
  }
  return files;
}

void RecentFiles::remember(const std::string& file) const {
  if (folder_.empty() || file.empty() || file.find('\n') != std::string::npos) return;
  std::error_code problem;
  std::filesystem::create_directories(folder_, problem);
  if (problem) {
    throw Error(ErrorKind::file, folder_, ": cannot be made, for the list of recent files: ", problem.message());
  }
  const std::string path = std::filesystem::absolute(file).lexically_normal().string();
  std::vector<std::string> files = list();
  std::erase(files, path);
  files.insert(files.begin(), path);
  files.resize(std::min(files.size(), kMost));
  std::string text;
  for (const std::string& each : files) text += each + "\n";
  write_file_atomically(folder_ / kName, std::as_bytes(std::span(text)));
}

}  // namespace bodyopt::viewport
