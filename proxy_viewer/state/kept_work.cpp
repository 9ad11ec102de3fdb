#include "proxy_viewer/state/kept_work.h"

#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <fstream>
#include <iterator>
#include <span>
#include <system_error>

#include "runtime/core/atomic_file.h"
#include "runtime/core/error.h"

namespace bodyopt {
namespace {

namespace fs = std::filesystem;

constexpr const char* kRecent = "recent.txt";
constexpr const char* kAside = ".unsaved.json";

void make_folder(const fs::path& folder) {
  std::error_code problem;
  fs::create_directories(folder, problem);
  if (problem) {
    throw Error(ErrorKind::file, folder.string() + ": cannot be made, to keep what is not saved: " + problem.message());
  }
}

// Also where its parent has not taken note of it yet.
bool has_ended(int process) {
  if (kill(process, 0) != 0 && errno == ESRCH) return true;
  std::ifstream file("/proc/" + std::to_string(process) + "/stat");
  const std::string stat(std::istreambuf_iterator<char>(file), {});
  const std::size_t name_ends = stat.rfind(") ");
  return name_ends != std::string::npos && stat.compare(name_ends + 2, 1, "Z") == 0;
}

// "1234.unsaved.json" of a process that has ended.
bool is_left(const fs::path& file) {
  const std::string name = file.filename().string();
  int process = 0;
  const auto [end, problem] = std::from_chars(name.data(), name.data() + name.size(), process);
  if (problem != std::errc{} || std::string_view(end) != kAside || process <= 0) return false;
  return has_ended(process);
}

}  // namespace

std::vector<std::string> KeptWork::recent() const {
  std::vector<std::string> files;
  std::ifstream list(folder_ / kRecent);
  for (std::string line; !folder_.empty() && files.size() < kMostRecent && std::getline(list, line);) {
    if (!line.empty()) files.push_back(line);
  }
  return files;
}

void KeptWork::remember(const std::string& file) const {
  if (folder_.empty() || file.empty() || file.find('\n') != std::string::npos) return;
  make_folder(folder_);
  const std::string path = fs::absolute(file).lexically_normal().string();
  std::vector<std::string> files = recent();
  std::erase(files, path);
  files.insert(files.begin(), path);
  files.resize(std::min(files.size(), kMostRecent));
  std::string text;
  for (const std::string& each : files) text += each + "\n";
  AtomicFile list(folder_ / kRecent);
  list.write(std::as_bytes(std::span(text)));
  list.commit();
}

fs::path KeptWork::own() const { return folder_ / (std::to_string(getpid()) + kAside); }

fs::path KeptWork::aside() const {
  if (folder_.empty()) return {};
  make_folder(folder_);
  return own();
}

fs::path KeptWork::left_behind() const {
  fs::path newest;
  fs::file_time_type written;
  std::error_code unreadable;
  if (folder_.empty()) return {};
  for (fs::directory_iterator entry(folder_, unreadable), end; !unreadable && entry != end;
       entry.increment(unreadable)) {
    std::error_code gone;
    const fs::file_time_type time = fs::last_write_time(entry->path(), gone);
    if (gone || !is_left(entry->path()) || (!newest.empty() && time <= written)) continue;
    newest = entry->path();
    written = time;
  }
  return newest;
}

void KeptWork::take_over(const fs::path& left) const {
  std::error_code problem;
  fs::rename(left, own(), problem);
}

void KeptWork::forget() const {
  std::error_code absent;
  if (!folder_.empty()) fs::remove(own(), absent);
}

}  // namespace bodyopt
