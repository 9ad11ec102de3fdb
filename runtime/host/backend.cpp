#include "runtime/host/backend.h"

#include "runtime/core/error.h"
#include "runtime/core/executor.h"

namespace bodyopt {

Executor& Backend::threads() const { return calling_thread(); }

void Backend::record(const Batch&, const vulkan::Recording&) {
  throw Error(ErrorKind::usage, "only an instance on a Vulkan device, without a check, can record");
}

}  // namespace bodyopt
