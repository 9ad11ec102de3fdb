// Keeps a second run from writing the same take at the same time.
#pragma once

#include <filesystem>

#include "runtime/core/file_lock.h"

namespace bodyopt {

// Holds a lock on a take while it lives.
class [[nodiscard]] TakeLock {
 public:
  // cache: that of the take's shapes; the lock is `.lock` in place of its ending, so that a draft and a full simulation
  // of one name, which share a side-car, exclude each other. Throws Error(file) when another run holds it.
  // Not explicit: a lock for one call is a path.
  TakeLock(std::filesystem::path cache);

  const std::filesystem::path& cache() const { return cache_; }

 private:
  std::filesystem::path cache_;
  RunLock lock_;
};

}  // namespace bodyopt
