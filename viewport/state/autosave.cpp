#include "viewport/state/autosave.h"

#include <unistd.h>

#include <string>
#include <system_error>

#include "runtime/core/error.h"

namespace bodyopt::viewport {
namespace {

namespace fs = std::filesystem;

constexpr const char* kEnding = ".unsaved.json";

fs::path lock_of(const fs::path& file) { return file.string() + ".lock"; }

// Whoever writes it holds its lock, on whatever machine, and loses it when killed.
bool has_ended(const fs::path& file) {
  try {
    const FileLock lock(lock_of(file));
    if (lock.is_held()) lock.remove_file();
    return lock.is_held();
  } catch (const Error&) {
    return false;
  }
}

}  // namespace

fs::path Autosave::file() {
  if (folder_.empty() || lock_) return file_;
  std::error_code problem;
  fs::create_directories(folder_, problem);
  if (problem) {
    throw Error(ErrorKind::file, folder_, ": cannot be made, to keep what is not saved: ", problem.message());
  }
  // An earlier process may have had the same number, and left a file.
  for (int k = 0; !lock_; ++k) {
    file_ = folder_ / (std::to_string(getpid()) + (k > 0 ? "-" + std::to_string(k) : "") + kEnding);
    FileLock lock(lock_of(file_));
    if (!lock.is_held()) continue;
    if (fs::exists(file_)) {
      lock.remove_file();
    } else {
      lock_.emplace(std::move(lock));
    }
  }
  return file_;
}

fs::path Autosave::left_behind() const {
  fs::path newest;
  fs::file_time_type written;
  std::error_code unreadable;
  if (folder_.empty()) return {};
  for (fs::directory_iterator entry(folder_, unreadable), end; !unreadable && entry != end;
       entry.increment(unreadable)) {
    std::error_code gone;
    const fs::file_time_type time = fs::last_write_time(entry->path(), gone);
    if (gone || !entry->path().string().ends_with(kEnding) || (!newest.empty() && time <= written)) continue;
    if (!has_ended(entry->path())) continue;
    newest = entry->path();
    written = time;
  }
  return newest;
}

void Autosave::take_over(const fs::path& left) {
  std::error_code problem;
  fs::rename(left, file(), problem);
  if (problem) throw Error(ErrorKind::file, left, ": cannot be taken over: ", problem.message());
}

bool Autosave::leave() {
  const bool is_there = lock_ && fs::exists(file_);
  if (lock_) lock_->remove_file();
  lock_.reset();
  file_.clear();
  return is_there;
}

void Autosave::forget() {
  std::error_code absent;
  if (!lock_) return;
  fs::remove(file_, absent);
  lock_->remove_file();
  lock_.reset();
  file_.clear();
}

}  // namespace bodyopt::viewport
