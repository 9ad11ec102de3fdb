#include "trainer/proxy/frame_time.h"

#include <omp.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "runtime/deformer.h"

namespace bodyopt {

FrameTime frame_time(const Basis& basis) {
  constexpr std::size_t kFrames = 32;
  constexpr int kRounds = 3;
  Deformer deformer(basis, {.name = "cpu"});
  const std::vector<Pose> poses(kFrames, bind_pose(basis.skeleton));
  double best = std::numeric_limits<double>::infinity();
  for (int round = 0; round < kRounds; ++round) {
    double seconds = 0;
    for (const auto& [stage, time] : deformer.evaluate(poses).stage_seconds) seconds += time;
    best = std::min(best, seconds);
  }
  return {1e6 * best / kFrames, omp_get_max_threads()};
}

}  // namespace bodyopt
