// The kind of error that a call throws.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "runtime/core/error.h"

namespace bodyopt::testing {

// Fails the test when there is no error, or one without a message.
inline ErrorKind kind_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& error) {
    EXPECT_GT(std::string(error.what()).size(), 20u);
    return error.kind();
  }
  ADD_FAILURE() << "no error";
  return ErrorKind::quality;
}

}  // namespace bodyopt::testing
