// A limit of the system's on this process, lower while it lives.
#pragma once

#include <gtest/gtest.h>
#include <sys/resource.h>

namespace bodyopt {

class LoweredLimit {
 public:
  // RLIMIT_FSIZE: bytes of a file; RLIMIT_NOFILE: files that are open.
  LoweredLimit(int resource, rlim_t most) : resource_(resource) {
    EXPECT_EQ(getrlimit(resource, &before_), 0);
    const rlimit limit{most, before_.rlim_max};
    EXPECT_EQ(setrlimit(resource, &limit), 0);
  }
  ~LoweredLimit() { EXPECT_EQ(setrlimit(resource_, &before_), 0); }
  LoweredLimit(const LoweredLimit&) = delete;
  LoweredLimit& operator=(const LoweredLimit&) = delete;

 private:
  int resource_;
  rlimit before_{};
};

}  // namespace bodyopt
