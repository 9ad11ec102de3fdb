#include "trainer/proxy/frame_time.h"

#include <algorithm>
#include <limits>
#include <vector>

#include "runtime/core/stopwatch.h"
#include "runtime/deformer/deformer.h"
#include "runtime/host/carry_skin.h"
#include "runtime/host/device_choice.h"
#include "runtime/threads/tbb_executor.h"

namespace bodyopt {

FrameTime frame_time(const Level& level) {
  constexpr std::size_t kFrames = 32;
  constexpr int kRounds = 3;
  Deformer deformer(level.basis, {.name = "cpu"});
  const std::vector<Pose> poses(kFrames, bind_pose(level.basis.skeleton));
  const std::unique_ptr<Executor> threads = make_tbb_executor();
  double best = std::numeric_limits<double>::infinity(), carrying = best;
  for (int round = 0; round < kRounds; ++round) {
    const Evaluation frames = deformer.evaluate(poses);
    best = std::min(best, frames.stage_seconds.sum());
    const Stopwatch watch;
    carry_skin(level.basis.mesh, level.carried, frames.positions, frames.normals, *threads);
    carrying = std::min(carrying, watch.seconds());
  }
  if (level.carried.empty()) carrying = 0;
  return {1e6 * best / kFrames, 1e6 * carrying / kFrames, static_cast<int>(thread_count())};
}

}  // namespace bodyopt
