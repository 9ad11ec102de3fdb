// bodyopt bench: how long a frame of a basis takes on each device, stage by stage and by what the host does, and how
// near to the memory's limit that is.
#include <algorithm>
#include <array>
#include <map>
#include <nlohmann/json.hpp>
#include <random>

#include "base/progress.h"
#include "cli/arguments/common.h"
#include "runtime/basis/dynamics.h"
#include "runtime/core/error.h"
#include "runtime/core/stopwatch.h"
#include "runtime/deformer/deformer.h"
#include "runtime/deformer/evaluate_together.h"
#include "runtime/host/backend.h"
#include "runtime/host/character_model.h"
#include "runtime/host/device_choice.h"
#include "runtime/host/stages.h"
#include "runtime/threads/tbb_executor.h"
#include "runtime/vulkan/backend/device_model.h"
#include "runtime/vulkan/commands.h"
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

// The threads of the CPU's kernels.
struct Threads {
  std::shared_ptr<Executor> executor;
  std::size_t count;
};

Threads threads_of(const BenchArguments& arguments) {
  if (arguments.one_thread) return {std::make_shared<SerialExecutor>(), 1};
  return {make_tbb_executor(), thread_count()};
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

// Copies on the device between buffers that no cache of it holds, bytes read and written per second.
double copy_bandwidth(const vulkan::Device& device) {
  constexpr std::size_t kCount = std::size_t{1} << 25;
  constexpr int kRounds = 5;
  const vulkan::Buffer from = floats(device, kCount, "the source of a copy"), to = floats(device, kCount, "a copy");
  vulkan::Commands commands(device);
  double best = 0;
  for (int round = 0; round < kRounds; ++round) {
    commands.begin();
    commands.timestamp();
    commands.copy(from, to);
    commands.timestamp();
    commands.end();
    const Stopwatch watch;
    commands.run();
    const std::vector<double> timed = commands.seconds();
    const double seconds = timed.empty() ? watch.seconds() : timed.front();  // of a device without timestamps
    best = std::max(best, static_cast<double>(from.size() + to.size()) / seconds);
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

// The least that a stage has to read and write: its tables once a batch, skins and matrices once a frame.
struct StageBytes {
  double tables = 0, frame = 0;
  double of_frame(double batch) const { return tables / batch + frame; }
};

std::map<Stage, StageBytes> bytes_of(const CharacterModel& model) {
  const Basis& basis = model.basis;
  const MeshTable& mesh = basis.mesh;
  const double skin = 12.0 * mesh.vertex_count(), matrices = 48.0 * static_cast<double>(basis.skeleton.size());
  std::map<std::string, std::size_t> tables = table_bytes(basis);
  std::map<Stage, StageBytes> bytes;
  const auto add = [&](Stage stage, const char* table, double frame) {
    bytes[stage] = {static_cast<double>(tables[table]), frame};
  };
  add(Stage::strain, "strain", matrices + 4.0 * basis.strain.fibre_count());
  add(Stage::residual, "residual", skin);
  add(Stage::modify, "modify", 2 * skin);
  add(Stage::pose, "ddm", matrices + 2 * skin);
  bytes[Stage::output] = {4.0 * static_cast<double>(mesh.triangles.size() + mesh.vertex_triangles.size()), 2 * skin};
  if (!model.dynamics) return bytes;
  const double nodes = 4.0 * static_cast<double>(model.dynamics->tets.nodes.size());
  tables = table_bytes(*model.dynamics);
  add(Stage::diffuse, "diffuse", skin + nodes);
  add(Stage::jiggle, "jiggle", 2 * skin + 5 * nodes);
  return bytes;
}

// A device, or the CPU, and the bytes per second that its memory gives.
struct Place {
  std::shared_ptr<const CharacterModel> model;
  Threads threads;
  std::shared_ptr<const vulkan::DeviceModel> on_device;  // none: the CPU
  double bandwidth;

  std::unique_ptr<Deformer> deformer(bool jiggles = false) const {
    const std::optional<JiggleOptions> options = jiggles ? std::optional(JiggleOptions{}) : std::nullopt;
    if (on_device) return std::make_unique<Deformer>(on_device, options);
    return std::make_unique<Deformer>(model, options, DeviceChoice{.name = "cpu", .executor = threads.executor});
  }
  std::string name() const { return on_device ? on_device->device().info().name : "cpu"; }
  // How many share the seconds of a stage.
  double workers() const { return on_device ? 1 : static_cast<double>(threads.count); }
};

// The median of all batches, seconds a frame.
struct FrameCost {
  double seconds = 0;
  StageSeconds stages;  // summed over threads
  HostSeconds host;
  double frames = 1;  // that the two above are of

  double of(Stage stage) const { return stages.of(stage).value_or(0) / frames; }
};

// Runs the calls together, again and again, for so long. The evaluations keep their memory, as those of a shot do.
// before: called each time, before them.
FrameCost measure(
    std::span<DeformerCall> calls, double seconds, const std::function<void()>& before = [] {}) {
  double frames = 0;
  for (const DeformerCall& call : calls) frames += static_cast<double>(call.poses.size());
  const auto run = [&] {
    before();
    const Stopwatch watch;
    evaluate_together(calls);
    FrameCost cost;
    cost.seconds = watch.seconds() / frames;
    cost.frames = frames;
    for (const DeformerCall& call : calls) {
      if (call.error) std::rethrow_exception(call.error);
      cost.stages.add(call.evaluation->stage_seconds);
      for (const auto& [name, part] : kHostParts) cost.host.*part += call.evaluation->host_seconds.*part;
    }
    return cost;
  };
  run();  // memory is got, caches fill
  std::vector<FrameCost> costs;
  const Stopwatch watch;
  do {
    stop_if_interrupted();
    costs.push_back(run());
  } while (watch.seconds() < seconds || costs.size() < 3);
  const auto middle = costs.begin() + static_cast<std::ptrdiff_t>(costs.size() / 2);
  std::ranges::nth_element(costs, middle, {}, &FrameCost::seconds);
  return *middle;
}

FrameCost measure_batch(Deformer& deformer, std::span<const Pose> poses, double seconds) {
  Evaluation evaluation;
  DeformerCall call{.deformer = &deformer, .poses = poses, .evaluation = &evaluation};
  return measure({&call, 1}, seconds);
}

// A frame of each of as many instances as there are poses, in one call.
FrameCost measure_instances(const Place& place, std::span<const Pose> poses, double seconds) {
  std::vector<std::unique_ptr<Deformer>> instances;
  std::vector<Evaluation> evaluations(poses.size());
  std::vector<DeformerCall> calls;
  for (std::size_t k = 0; k < poses.size(); ++k) {
    instances.push_back(place.deformer());
    calls.push_back({.deformer = instances.back().get(), .poses = poses.subspan(k, 1), .evaluation = &evaluations[k]});
  }
  return measure(calls, seconds);
}

// A frame at a time that jiggles, each after the one before.
FrameCost measure_jiggle(const Place& place, std::span<const Pose> poses, double seconds) {
  const std::unique_ptr<Deformer> deformer = place.deformer(true);
  Evaluation evaluation;
  int frame = 0;
  DeformerCall call{
      .deformer = deformer.get(), .poses = poses.first(1), .evaluation = &evaluation, .frames = std::span(&frame, 1)};
  return measure({&call, 1}, seconds, [&] { ++frame; });
}

// What is measured of a basis, as JSON and as a table.
class Report {
 public:
  Report(const CharacterModel& model, double triad)
      : bytes_(bytes_of(model)), total_(total_bytes(model.basis)), triad_(triad) {
    const MeshTable& mesh = model.basis.mesh;
    total_ += 24.0 * (mesh.vertex_count() + mesh.output_count());  // what a frame writes, once each
    stages_ = {Stage::rig};
    for (const Stage stage : stages_of(model.basis, Batch{})) stages_.push_back(stage);
    if (model.dynamics) stages_.insert(stages_.end() - 1, {Stage::diffuse, Stage::jiggle});
    text_ = format(
        "{} vertices, {} joints: {:.2f} MB a frame; triad {:.1f} GB/s; ms a frame, stages summed over threads, and\n"
        "below each how near it is to reading and writing what it must at the memory's speed, %\n{:>10} {:>9}",
        mesh.vertex_count(), model.basis.skeleton.size(), total_ / 1e6, triad / 1e9, "frames", "frame");
    for (const Stage stage : stages_) text_ += format(" {:>9}", name_of(stage));
    for (const auto& [name, part] : kHostParts) text_ += format(" {:>9}", name);
    text_ += format(" {:>7} {:>8}  {}\n", "GB/s", "of triad", "device");
  }

  // `what`: "16", "4 bodies"; `batch`: frames that read the tables once. Adds a row to the list of that name.
  void add(const char* list, const std::string& what, const Place& place, double batch, const FrameCost& cost,
           Json row) {
    Json stage_ms = Json::object(), stage_bytes = Json::object(), of_limit = Json::object(), host_ms = Json::object();
    std::string line = format("{:>10} {:9.4f}", what, 1e3 * cost.seconds), below = format("{:20}", "");
    for (const Stage stage : stages_) {
      const double seconds = cost.of(stage);
      stage_ms[name_of(stage)] = 1e3 * seconds;
      line += format(" {:9.4f}", 1e3 * seconds);
      const auto bytes = bytes_.find(stage);
      if (bytes == bytes_.end() || seconds == 0) {
        below += format(" {:>9}", "");
        continue;
      }
      const double needed = bytes->second.of_frame(batch);
      stage_bytes[name_of(stage)] = needed;
      of_limit[name_of(stage)] = needed / place.bandwidth * place.workers() / seconds;
      below += format(" {:9.1f}", 100 * of_limit[name_of(stage)].get<double>());
    }
    for (const auto& [name, part] : kHostParts) {
      host_ms[name] = 1e3 * cost.host.*part / cost.frames;
      line += format(" {:9.4f}", host_ms[name].get<double>());
    }
    const double bandwidth = total_ / cost.seconds;
    text_ +=
        format("{} {:7.2f} {:7.0f}%  {}\n{}\n", line, bandwidth / 1e9, 100 * bandwidth / triad_, place.name(), below);
    row.update({{"device", place.name()},
                {"frame_ms", 1e3 * cost.seconds},
                {"stage_ms", stage_ms},
                {"stage_bytes", stage_bytes},
                {"stage_of_limit", of_limit},
                {"host_ms", host_ms},
                {"bytes", total_},
                {"bytes_per_second", bandwidth},
                {"of_triad", bandwidth / triad_},
                {"memory_bytes_per_second", place.bandwidth}});
    lists_[list].push_back(std::move(row));
  }

  void emit(const BenchArguments& arguments) const {
    Json result{{"basis", arguments.basis}, {"triad_bytes_per_second", triad_}};
    result.update(lists_);
    arguments.json.emit(result, text_);
  }

 private:
  std::map<Stage, StageBytes> bytes_;
  double total_, triad_;
  std::vector<Stage> stages_;
  Json lists_{{"measured", Json::array()}, {"instances", Json::array()}, {"jiggle", Json::array()}};
  std::string text_;
};

void measure_place(const Place& place, std::span<const Pose> poses, double seconds, Report& report) {
  const std::unique_ptr<Deformer> deformer = place.deformer();
  for (const std::size_t batch : {1, 4, 16, 64}) {
    const FrameCost cost = measure_batch(*deformer, poses.first(batch), seconds);
    report.add("measured", std::to_string(batch), place, static_cast<double>(batch), cost, {{"batch", batch}});
  }
  for (const std::size_t bodies : {4, 16}) {
    const FrameCost cost = measure_instances(place, poses.first(bodies), seconds);
    report.add("instances", format("{} bodies", bodies), place, 1, cost, {{"instances", bodies}});
  }
  if (place.model->dynamics) report.add("jiggle", "jiggle", place, 1, measure_jiggle(place, poses, seconds), {});
}

std::vector<std::string> devices_of(const BenchArguments& arguments) {
  if (!arguments.device.empty()) return {arguments.device};
  std::vector<std::string> devices = {"cpu"};
  for (const vulkan::DeviceInfo& device : vulkan::list_devices()) devices.push_back(std::to_string(device.index));
  return devices;
}

Place open_place(const std::string& name, std::shared_ptr<const CharacterModel> model, const Threads& threads,
                 double triad) {
  if (name == "cpu") return {std::move(model), threads, nullptr, triad};
  const auto device =
      std::make_shared<const vulkan::Device>(DeviceChoice{.name = name, .pipeline_cache = cache_folder()});
  return {model, threads, std::make_shared<const vulkan::DeviceModel>(device, model), copy_bandwidth(*device)};
}

void run(const BenchArguments& arguments) {
  arguments.json.require_writable();
  Basis basis = load_basis(arguments.basis);
  std::optional<Dynamics> dynamics;
  const std::filesystem::path beside = dynamics_beside(arguments.basis);
  if (std::filesystem::exists(beside)) dynamics = load_dynamics(beside, basis);
  const std::shared_ptr<const CharacterModel> model = make_character_model(std::move(basis), std::move(dynamics));
  const Threads threads = threads_of(arguments);
  const double triad = triad_bandwidth(*threads.executor);
  const std::vector<Pose> poses = random_poses(model->basis.skeleton, 64);
  Report report(*model, triad);
  for (const std::string& name : devices_of(arguments)) {
    measure_place(open_place(name, model, threads, triad), poses, arguments.seconds, report);
  }
  report.emit(arguments);
}

}  // namespace

void add_bench(CLI::App& app) {
  const auto [verb, arguments] = add_verb<BenchArguments>(
      app, "bench", "Measure how long a frame takes on each device, stage by stage, and what the host does", run);
  add_option(verb, "BASIS", arguments.basis, "The trained character; it jiggles where its dynamics are beside it")
      ->required();
  add_option(verb, "--device", arguments.device, "Only this one: cpu, or a Vulkan device by index or name");
  add_number(verb, "--seconds", arguments.seconds, 0.01, 600, "How long each row is measured, for a median");
  add_flag(verb, "--one-thread", arguments.one_thread, "The CPU's kernels on one thread");
  arguments.json.add(verb);
}

}  // namespace bodyopt::cli
