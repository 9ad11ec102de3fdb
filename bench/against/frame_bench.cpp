// Times frames of a basis by what every version of the runtime has had: a Deformer, and the seconds of its stages.
// The script bench/against/compare.py compiles this beside two versions. `frame_bench DEVICE BASIS [DYNAMICS]` prints a
// line for each figure. It has what was run, the stage, and ms a frame, of the quickest run. The stages "clock" and
// "processors" are all of the frame, on the clock and of all threads.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <map>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "runtime/basis/dynamics.h"
#include "runtime/deformer/deformer.h"
#include "runtime/host/device_choice.h"

namespace bodyopt::bench {
namespace {

constexpr std::size_t kFrames = 16;
constexpr double kSeconds = 1;

// Joints turned by up to 0.15 radians from the bind pose.
std::vector<Pose> random_poses(const Skeleton& skeleton) {
  std::mt19937 random(1);
  const auto number = [&] { return random() / 4294967296.0 - 0.5; };
  std::vector<Pose> poses(kFrames, bind_pose(skeleton));
  for (Pose& pose : poses) {
    for (auto& joint : pose.joints) {
      const Vec3 axis{number(), number(), number()};
      joint.rotation = normalized(joint.rotation * axis_angle((1 / length(axis)) * axis, 0.3 * number()));
    }
  }
  return poses;
}

// Earlier versions have a map.
template <typename Seconds, typename Keep>
void for_each_stage(const Seconds& stages, const Keep& keep) {
  if constexpr (requires { stages.begin(); }) {
    for (const auto& [stage, seconds] : stages) keep(stage, seconds);
  } else {
    stages.for_each([&](const auto& stage, double seconds) { keep(stage.name, seconds); });
  }
}

// `run`: evaluates frames, gives the seconds of each stage.
template <typename Run>
void measure(const char* what, std::size_t frames, const Run& run) {
  using Clock = std::chrono::steady_clock;
  std::map<std::string, double> quickest;
  const auto keep = [&](const std::string& stage, double seconds) {
    const auto [found, is_new] = quickest.emplace(stage, seconds);
    if (!is_new) found->second = std::min(found->second, seconds);
  };
  run();  // memory is got, caches fill
  const auto start = Clock::now();
  for (int round = 0; round < 3 || Clock::now() - start < std::chrono::duration<double>(kSeconds); ++round) {
    const auto begin = Clock::now();
    const std::clock_t used = std::clock();
    const auto stages = run();
    keep("processors", static_cast<double>(std::clock() - used) / CLOCKS_PER_SEC);
    keep("clock", std::chrono::duration<double>(Clock::now() - begin).count());
    for_each_stage(stages, keep);
  }
  for (const auto& [stage, seconds] : quickest) {
    std::printf("%s\t%s\t%.6f\n", what, stage.c_str(), 1e3 * seconds / static_cast<double>(frames));
  }
}

void run(const char* device, const char* basis_file, const char* dynamics_file) {
  const Basis basis = load_basis(basis_file);
  const std::vector<Pose> poses = random_poses(basis.skeleton);
  DeviceChoice choice;
  choice.name = device;
  Deformer still(basis, choice);
  measure("one frame", 1, [&] { return still.evaluate(std::span(poses).first(1)).stage_seconds; });
  measure("frames of 16", kFrames, [&] { return still.evaluate(poses).stage_seconds; });
  if (dynamics_file == nullptr) return;
  Deformer jiggling(basis, load_dynamics(dynamics_file, basis), JiggleOptions{}, choice);
  std::vector<int> numbers(kFrames);
  int next = 0;
  measure("frames that jiggle", kFrames, [&] {
    for (int& number : numbers) number = next++;
    return jiggling.jiggle(poses, numbers).stage_seconds;
  });
}

}  // namespace
}  // namespace bodyopt::bench

int main(int argc, char** argv) {
  if (argc != 3 && argc != 4) {
    std::fputs("usage: frame_bench DEVICE BASIS [DYNAMICS]\n", stderr);
    return 64;
  }
  try {
    bodyopt::bench::run(argv[1], argv[2], argc == 4 ? argv[3] : nullptr);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "frame_bench: %s\n", error.what());
    return 1;
  }
  return 0;
}
