// bodyopt bench: how long a frame of a basis takes on each device, stage by stage, and how near the memory's that is.
#include <algorithm>
#include <nlohmann/json.hpp>
#include <random>

#include "base/progress.h"
#include "cli/arguments/common.h"
#include "runtime/core/error.h"
#include "runtime/core/stopwatch.h"
#include "runtime/deformer/deformer.h"
#include "runtime/deformer/evaluate_together.h"
#include "runtime/host/backend.h"
#include "runtime/host/stages.h"
#include "runtime/threads/tbb_executor.h"
#include "runtime/vulkan/device.h"

namespace bodyopt::cli {
namespace {

struct BenchArguments {
  std::string basis, device;
  double seconds = 1;
  bool one_thread = false;
  JsonOption json;
};

void stop_if_interrupted() {
  if (interrupted()) throw Error(ErrorKind::interrupted, "interrupted; nothing of the measurement is kept");
}

std::shared_ptr<Executor> threads_of(const BenchArguments& arguments) {
  if (arguments.one_thread) return std::make_shared<SerialExecutor>();
  return make_tbb_executor();
}

// a = b + 3 c over arrays that no cache holds, bytes per second: what the processor's memory gives at most.
double triad_bandwidth(Executor& threads) {
  constexpr std::size_t kCount = std::size_t{1} << 24;
  constexpr int kRounds = 5;
  std::vector<float> a(kCount), b(kCount, 1.0f), c(kCount, 2.0f);
  double best = 0;
  for (int round = 0; round < kRounds; ++round) {
    const Stopwatch watch;
    parallel_parts(threads, kCount, kCount / 64, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) a[k] = b[k] + 3 * c[k];
    });
    best = std::max(best, 3 * sizeof(float) * kCount / watch.seconds());
  }
  return best;
}

// Joints turned by up to 0.3 radians from the bind pose, the same poses every time.
std::vector<Pose> random_poses(const Skeleton& skeleton, std::size_t count) {
  std::mt19937 random(1);
  const auto number = [&] { return random() / 4294967296.0 - 0.5; };
  std::vector<Pose> poses(count, bind_pose(skeleton));
  for (Pose& pose : poses) {
    for (JointTransform& joint : pose.joints) {
      const Vec3 axis{number(), number(), number()};
      joint.rotation =
          normalized(joint.rotation * axis_angle((1 / std::max(1e-3, length(axis))) * axis, 0.6 * number()));
    }
  }
  return poses;
}

// Bytes of tables that a frame has to read, and of what it writes, each once.
std::size_t frame_bytes(const Basis& basis) {
  return total_bytes(basis) + 2 * 3 * sizeof(float) * (basis.mesh.vertex_count() + basis.mesh.output_count());
}

struct FrameCost {
  double seconds = 0;          // of a frame, the median of all batches
  StageSeconds batch_seconds;  // of all frames of that batch
};

FrameCost measure(Deformer& deformer, std::span<const Pose> poses, double seconds) {
  Evaluation evaluation;  // keeps its memory, as that of a shot does
  const auto evaluate = [&] {
    DeformerCall call{.deformer = &deformer, .poses = poses, .evaluation = &evaluation};
    evaluate_together({&call, 1});
    if (call.error) std::rethrow_exception(call.error);
    return evaluation.stage_seconds;
  };
  evaluate();  // memory is got, caches fill
  std::vector<FrameCost> costs;
  const Stopwatch watch;
  do {
    stop_if_interrupted();
    const Stopwatch batch;
    FrameCost cost{0, evaluate()};
    cost.seconds = batch.seconds() / static_cast<double>(poses.size());
    costs.push_back(cost);
  } while (watch.seconds() < seconds || costs.size() < 3);
  const auto middle = costs.begin() + static_cast<std::ptrdiff_t>(costs.size() / 2);
  std::nth_element(costs.begin(), middle, costs.end(),
                   [](const auto& a, const auto& b) { return a.seconds < b.seconds; });
  return *middle;
}

std::vector<std::string> devices_of(const BenchArguments& arguments) {
  if (!arguments.device.empty()) return {arguments.device};
  std::vector<std::string> devices = {"cpu"};
  for (const vulkan::DeviceInfo& device : vulkan::list_devices()) devices.push_back(std::to_string(device.index));
  return devices;
}

void run(const BenchArguments& arguments) {
  arguments.json.require_writable();
  const Basis basis = load_basis(arguments.basis);
  const std::shared_ptr<Executor> threads = threads_of(arguments);
  const double triad = triad_bandwidth(*threads);
  const std::vector<Pose> poses = random_poses(basis.skeleton, 64);
  const double bytes = static_cast<double>(frame_bytes(basis));
  Json rows = Json::array();
  std::string text =
      format("{} vertices, {} joints: {:.2f} MB a frame; triad {:.1f} GB/s; ms a frame, stages summed over threads\n",
             basis.mesh.vertex_count(), basis.skeleton.size(), bytes / 1e6, triad / 1e9);
  std::vector<Stage> stages = {Stage::rig};
  for (const Stage stage : stages_of(basis, Batch{})) stages.push_back(stage);
  text += format("{:>5} {:>9}", "batch", "frame");
  for (const Stage stage : stages) text += format(" {:>9}", name_of(stage));
  text += format(" {:>7} {:>8}  {}\n", "GB/s", "of triad", "device");
  for (const std::string& name : devices_of(arguments)) {
    Deformer deformer(basis, {.name = name, .executor = threads, .pipeline_cache = cache_folder()});
    for (const std::size_t batch : {1, 4, 16, 64}) {
      const FrameCost cost = measure(deformer, std::span(poses).first(batch), arguments.seconds);
      const double bandwidth = bytes / cost.seconds;
      Json stage_ms = Json::object();
      text += format("{:5} {:9.4f}", batch, 1e3 * cost.seconds);
      for (const Stage stage : stages) {
        const double ms = 1e3 * cost.batch_seconds.of(stage).value_or(0) / static_cast<double>(batch);
        stage_ms[name_of(stage)] = ms;
        text += format(" {:9.4f}", ms);
      }
      text += format(" {:7.2f} {:7.0f}%  {}\n", bandwidth / 1e9, 100 * bandwidth / triad, deformer.device_name());
      rows.push_back({{"device", deformer.device_name()},
                      {"batch", batch},
                      {"frame_ms", 1e3 * cost.seconds},
                      {"stage_ms", stage_ms},
                      {"bytes", bytes},
                      {"bytes_per_second", bandwidth},
                      {"of_triad", bandwidth / triad}});
    }
  }
  arguments.json.emit({{"basis", arguments.basis}, {"triad_bytes_per_second", triad}, {"measured", rows}}, text);
}

}  // namespace

void add_bench(CLI::App& app) {
  const auto [verb, arguments] =
      add_verb<BenchArguments>(app, "bench", "Measure how long a frame takes on each device, stage by stage", run);
  add_option(verb, "BASIS", arguments.basis, "The trained character")->required();
  add_option(verb, "--device", arguments.device, "Only this one: cpu, or a Vulkan device by index or name");
  add_number(verb, "--seconds", arguments.seconds, 0.01, 600, "How long each batch size is measured, for a median");
  add_flag(verb, "--one-thread", arguments.one_thread, "The CPU's kernels on one thread");
  arguments.json.add(verb);
}

}  // namespace bodyopt::cli
