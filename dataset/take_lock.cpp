#include "dataset/take_lock.h"

namespace bodyopt {

TakeLock::TakeLock(std::filesystem::path cache)
    : cache_(std::move(cache)),
      lock_(
          std::filesystem::path(cache_).replace_extension(".lock"),
          "writing this take right now, and two would mix up its frames: wait for it to end, or write a take of another "
          "name") {}

}  // namespace bodyopt
