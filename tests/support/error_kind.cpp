#include "tests/support/error_kind.h"

#include <gtest/gtest.h>

#include <string>

namespace bodyopt::testing {

ErrorKind kind_of(const std::function<void()>& call) {
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
