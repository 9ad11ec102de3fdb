// Keeps a second run from writing the same take at the same time.
#pragma once

#include <filesystem>

namespace bodyopt {

// Holds a lock on a take while it lives. The system gives it up when the process dies, however it dies; what is left of
// the file then locks nothing. Where the file system knows no locks, there is none.
class TakeLock {
 public:
  // cache: that of the take's shapes; the lock is `.lock` in place of its ending, so that a draft and a full simulation
  // of one name, which share a side-car, exclude each other. Throws Error(file) when another run holds it.
  // Not explicit: a lock for one call is a path.
  TakeLock(std::filesystem::path cache);
  ~TakeLock();
  TakeLock(const TakeLock&) = delete;
  TakeLock& operator=(const TakeLock&) = delete;

  const std::filesystem::path& cache() const { return cache_; }

 private:
  bool is_at_its_path() const;

  std::filesystem::path cache_, path_;
  int file_ = -1;
};

}  // namespace bodyopt
