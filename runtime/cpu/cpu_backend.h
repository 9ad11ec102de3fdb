// The stages on the CPU: what every kernel is checked against, and what runs where there is no device.
#pragma once

#include <memory>

#include "runtime/host/backend.h"

namespace bodyopt {

std::unique_ptr<Backend> make_cpu_backend(const Basis& basis, const JiggleModel& jiggle = {});

}  // namespace bodyopt
