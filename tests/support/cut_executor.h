// An executor that cuts every loop in three, however short it is, and does the last part first.
#pragma once

#include <algorithm>

#include "runtime/core/executor.h"

namespace bodyopt::testing {

class CutExecutor final : public Executor {
 public:
  void parallel_for(std::size_t count, std::size_t, Task task, const void* context) override {
    const std::size_t parts = std::min<std::size_t>(count, 3);
    for (std::size_t k = parts; k-- > 0;) task(context, k * count / parts, (k + 1) * count / parts);
    calls += parts > 1;
  }

  std::size_t calls = 0;  // that were cut
};

}  // namespace bodyopt::testing
