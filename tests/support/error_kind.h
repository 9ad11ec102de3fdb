// The kind of error that a call throws.
#pragma once

#include <functional>

#include "runtime/core/error.h"

namespace bodyopt::testing {

// Fails the test when there is no error, or one without a message.
ErrorKind kind_of(const std::function<void()>& call);

}  // namespace bodyopt::testing
