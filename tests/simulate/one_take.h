// A take alone, in a body that is made for it.
#pragma once

#include <filesystem>
#include <vector>

#include "trainer/simulate/simulate.h"

namespace bodyopt::trainer {

inline std::vector<FrameStatus> simulate_one_take(const Character& character, const std::vector<Muscle>& muscles,
                                                  const Clip& clip, const std::vector<int>& frames,
                                                  const TakeLock& take, const std::filesystem::path& status,
                                                  const SimulateOptions& options) {
  return simulate(make_compared_body(character, muscles, options), character, muscles, clip, frames, take, status,
                  options);
}

}  // namespace bodyopt::trainer
