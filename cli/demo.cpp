// bodyopt demo: the whole path on the built-in arm, from character to report.
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <numeric>

#include "cli/common.h"
#include "cli/report/pictures.h"
#include "cli/report/report.h"
#include "runtime/basis/error.h"
#include "trainer/builtin/arm.h"
#include "trainer/dataset/frame_range.h"
#include "trainer/dataset/pc2.h"
#include "trainer/simulate/simulate.h"
#include "trainer/train/heldout.h"

namespace bodyopt::cli {
namespace {

namespace fs = std::filesystem;

struct DemoArguments {
  std::string out;
  bool quick = false;
  DeviceArguments device;
  JsonOption json;
};

struct DemoSize {
  int train_frames, heldout_frames;
};
constexpr DemoSize kFull{440, 144}, kQuick{48, 24};
// Simulating every second frame of the held-out motion shows its whole arc at half the cost.
constexpr int kHeldoutStep = 2;
constexpr std::uint64_t kRangeOfMotionSeed = 2023;

class Stopwatch {
 public:
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

std::size_t total_bytes(const Basis& basis) {
  std::size_t bytes = 0;
  for (const auto& [stage, size] : table_bytes(basis)) bytes += size;
  return bytes;
}

// The files a user would bring: character, muscles and two clips.
void write_inputs(const fs::path& folder, const DemoSize& size) {
  const BuiltinArm arm = build_arm();
  const Skeleton& skeleton = arm.character.skeleton;
  write_character(arm.character, folder / "character.glb");
  write_muscles(arm.muscles, skeleton, folder / "muscles.json");
  write_clip(arm_range_of_motion(skeleton, size.train_frames, kRangeOfMotionSeed), skeleton, folder / "rom.glb");
  write_clip(arm_heldout(skeleton, size.heldout_frames), skeleton, folder / "heldout.glb");
}

// Simulates one clip of the folder into folder/dataset.
DatasetTake simulate_take(const fs::path& folder, const std::string& name, int step, bool heldout) {
  const Character character = read_character(folder / "character.glb");
  const std::vector<Muscle> muscles = read_muscles(folder / "muscles.json", character.skeleton);
  const Clip clip = read_clip((folder / (name + ".glb")).string(), character.skeleton, {});
  DatasetTake take;
  take.name = name;
  take.clip = "../" + name + ".glb";
  for (int frame = clip.first_frame; frame <= clip.last_frame(); frame += step) take.frames.push_back(frame);
  if (heldout) take.heldout = take.frames;
  take.shapes = name + ".pc2";
  take.shapes_status = name + ".status.json";
  simulate(character, muscles, clip, take.frames, folder / "dataset" / take.shapes,
           folder / "dataset" / take.shapes_status, {});
  return take;
}

Dataset simulate_dataset(const fs::path& folder) {
  Dataset dataset;
  dataset.folder = folder / "dataset";
  fs::create_directories(dataset.folder);
  dataset.character = "../character.glb";
  dataset.muscles = "../muscles.json";
  dataset.takes = {simulate_take(folder, "rom", 1, false), simulate_take(folder, "heldout", kHeldoutStep, true)};
  write_dataset(dataset, dataset.folder / "dataset.json");
  return dataset;
}

std::vector<Pose> heldout_poses(const SampleSet& set) {
  std::vector<Pose> poses;
  for (const Sample& sample : set.heldout) poses.push_back(sample.pose);
  return poses;
}

void write_cache(const fs::path& path, const SampleSet& set, const Evaluation& evaluation) {
  const std::size_t stride = 3 * std::size_t{set.character.output_count()};
  Pc2Writer writer(path, set.character.output_count(), static_cast<std::uint32_t>(set.heldout.size()));
  for (std::size_t k = 0; k < set.heldout.size(); ++k) {
    writer.append(std::span(evaluation.positions).subspan(k * stride, stride));
  }
  writer.close();
}

double largest_difference(const std::vector<float>& a, const std::vector<float>& b) {
  double largest = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    largest = std::max(largest, std::abs(static_cast<double>(a[k]) - static_cast<double>(b[k])));
  }
  return largest;
}

std::vector<float> to_float(const Positions& positions) {
  return {positions.data(), positions.data() + positions.size()};
}

}  // namespace
}  // namespace bodyopt::cli
