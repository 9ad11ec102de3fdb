// bodyopt.h: the log.
#include <mutex>
#include <shared_mutex>

#include "runtime/library/guard.h"

namespace bodyopt {
namespace {

// Held shared while the host's function runs, so that nobody exchanges it meanwhile.
std::shared_mutex mutex;
bodyopt_log host_log = nullptr;
void* host_user = nullptr;
thread_local bool is_telling = false;  // this thread is in the host's function

}  // namespace

void write_log(bodyopt_log_level level, const char* message) noexcept {
  if (is_telling) return;
  const std::shared_lock lock(mutex);
  if (host_log == nullptr) return;
  is_telling = true;
  try {
    host_log(level, message, host_user);
  } catch (...) {  // the call itself is none the worse
  }
  is_telling = false;
}

}  // namespace bodyopt

using namespace bodyopt;

bodyopt_result bodyopt_set_log(bodyopt_log log, void* user) {
  return guarded([&] {
    if (is_telling) throw Error(ErrorKind::usage, "bodyopt_set_log was called by the log's own function");
    const std::unique_lock lock(mutex);
    host_log = log;
    host_user = user;
  });
}
