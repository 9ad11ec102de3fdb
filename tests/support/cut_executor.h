// An executor that cuts loops as finely as it may, and does the last part first.
#pragma once

#include <algorithm>

#include "runtime/core/executor.h"

namespace bodyopt::testing {

class CutExecutor final : public Executor {
 public:
  void parallel_for(std::size_t count, std::size_t grain, Task task, const void* context) override {
    const std::size_t parts = std::max<std::size_t>(count > 0, count / grain);
    for (std::size_t k = parts; k-- > 0;) task(context, k * count / parts, (k + 1) * count / parts);
    calls += parts > 1;
  }

  std::size_t calls = 0;  // that were cut
};

}  // namespace bodyopt::testing
