// The sets of instructions that kernels in lanes are compiled for.
#pragma once

#include <hwy/targets.h>

#include <cstdint>
#include <functional>
#include <string>

namespace bodyopt::testing {

// Calls it with each set that the processor has in use, and its name. Returns how many these are.
inline int with_each_instruction_set(const std::function<void(const std::string& name)>& call) {
  int sets = 0;
  const auto choose = [](std::int64_t targets) {
    hwy::SetSupportedTargetsForTest(targets);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  };
  for (std::int64_t left = hwy::SupportedTargets(); left != 0; left &= left - 1) {
    const std::int64_t target = left & -left;
    choose(target);
    call(hwy::TargetName(target));
    ++sets;
  }
  choose(0);
  return sets;
}

}  // namespace bodyopt::testing
