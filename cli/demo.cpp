// bodyopt demo: the whole path on the built-in arm, from character to report.
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <numeric>
#include <set>

#include "cli/common.h"
#include "cli/report/pictures.h"
#include "cli/report/report.h"
#include "runtime/basis/error.h"
#include "runtime/rig.h"
#include "trainer/builtin/arm.h"
#include "trainer/builtin/arm_dofs.h"
#include "trainer/dataset/json_file.h"
#include "trainer/dataset/pc2.h"
#include "trainer/motion/range_of_motion.h"
#include "trainer/simulate/simulate.h"
#include "trainer/train/heldout.h"
#include "trainer/train/trade_off.h"

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
  int rom_frames, heldout_frames;
};
constexpr DemoSize kFull{400, 144}, kQuick{48, 24};
// Every so manieth frame of the range of motion is also simulated with muscles flexed.
constexpr int kFlexedStep = 10;
// Simulating every second frame of the held-out motion shows its whole arc at half the cost.
constexpr int kHeldoutStep = 2;

class Stopwatch {
 public:
  double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

// Three groups of muscles flexed and relaxed in turns over a clip.
void write_flex(const fs::path& path, int frames) {
  constexpr int kTurns = 9;
  const std::vector<std::string> groups{"biceps*", "triceps*", "deltoid*"};
  Json controls;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    Json curve = Json::array();
    for (std::size_t turn = 0; turn <= kTurns; ++turn) {
      const double frame = 1 + static_cast<double>(turn) / kTurns * frames;
      curve.push_back({frame, turn % groups.size() == g ? 1 : 0});
    }
    controls[groups[g]] = curve;
  }
  write_json({{"schema", "bodyopt-controls-1"}, {"controls", controls}}, path);
}

// The files a user would bring: character, muscles, limits, two clips and how muscles flex in one of them.
void write_inputs(const fs::path& folder, const DemoSize& size) {
  const BuiltinArm arm = build_arm();
  const Skeleton& skeleton = arm.character.skeleton;
  write_character(arm.character, folder / "character.glb");
  write_muscles(arm.muscles, skeleton, folder / "muscles.json");
  const JointLimits limits = arm_limits(skeleton);
  write_joint_limits(limits, skeleton, folder / "limits.json");
  const RangeOfMotion motion = range_of_motion(arm.character, limits, {.frames = size.rom_frames});
  write_clip(clip_of(motion, limits, skeleton), skeleton, folder / "rom.glb");
  write_flex(folder / "flex.json", size.rom_frames);
  write_clip(arm_heldout(skeleton, size.heldout_frames), skeleton, folder / "heldout.glb");
}

std::vector<int> every(int step, int last) {
  std::vector<int> frames;
  for (int frame = 1; frame <= last; frame += step) frames.push_back(frame);
  return frames;
}

DatasetTake take_of(const std::string& name, const std::string& clip, const std::vector<int>& frames) {
  DatasetTake take;
  take.name = name;
  take.clip = "../" + clip;
  take.frames = frames;
  take.shapes = name + ".pc2";
  take.shapes_status = name + ".status.json";
  return take;
}

Dataset dataset_in(const fs::path& folder) {
  Dataset dataset;
  dataset.folder = folder;
  dataset.character = "../character.glb";
  dataset.muscles = "../muscles.json";
  return dataset;
}

void simulate_takes(const Dataset& dataset, const SimulateOptions& options) {
  fs::create_directories(dataset.folder);
  const Character character = read_character(dataset.folder / dataset.character);
  const std::vector<Muscle> muscles = read_muscles(dataset.folder / dataset.muscles, character.skeleton);
  for (const DatasetTake& take : dataset.takes) {
    simulate(character, muscles, read_clip(dataset, take, character.skeleton), take.frames,
             dataset.folder / take.shapes, dataset.folder / take.shapes_status, options);
  }
  write_dataset(dataset, dataset.folder / "dataset.json");
}

Dataset simulate_dataset(const fs::path& folder, const DemoSize& size) {
  Dataset dataset = dataset_in(folder / "dataset");
  const std::vector<int> heldout = every(kHeldoutStep, size.heldout_frames);
  dataset.takes = {take_of("rom", "rom.glb", every(1, size.rom_frames)),
                   take_of("flexed", "rom.glb", every(kFlexedStep, size.rom_frames)),
                   take_of("heldout", "heldout.glb", heldout)};
  dataset.takes[1].controls = "../flex.json";
  dataset.takes[2].heldout = heldout;
  simulate_takes(dataset, {});
  return dataset;
}

// The held-out motion as a draft, to be held against the full simulation of it.
Dataset simulate_draft(const fs::path& folder, const DemoSize& size) {
  Dataset dataset = dataset_in(folder / "draft");
  dataset.takes = {take_of("heldout", "heldout.glb", every(kHeldoutStep, size.heldout_frames))};
  dataset.takes[0].shapes = "heldout.nodes";
  dataset.takes[0].heldout = dataset.takes[0].frames;
  simulate_takes(dataset, {.draft = true});
  return dataset;
}

std::vector<Pose> heldout_poses(const SampleSet& set) {
  std::vector<Pose> poses;
  for (const Sample& sample : set.heldout) poses.push_back(sample.pose);
  return poses;
}

std::vector<Positions> welded_shapes(const SampleSet& set, const Evaluation& evaluation) {
  std::vector<Positions> shapes;
  const std::size_t stride = 3 * std::size_t{set.character.output_count()};
  for (std::size_t k = 0; k < set.heldout.size(); ++k) {
    shapes.push_back(welded_from_output(set.character, evaluation.positions.data() + k * stride));
  }
  return shapes;
}

std::vector<int> heldout_frames(const SampleSet& set) {
  std::vector<int> frames;
  for (const Sample& sample : set.heldout) frames.push_back(sample.frame);
  return frames;
}

void write_cache(const fs::path& path, const SampleSet& set, const Evaluation& evaluation) {
  const std::vector<int> frames = heldout_frames(set);
  const std::size_t stride = 3 * std::size_t{set.character.output_count()};
  Pc2Writer writer(path, set.character.output_count(), static_cast<std::uint32_t>(frames.size()),
                   frames.empty() ? 1.0f : static_cast<float>(frames.front()), frame_spacing(frames));
  for (std::size_t k = 0; k < set.heldout.size(); ++k) {
    writer.append(std::span(evaluation.positions).subspan(k * stride, stride));
  }
  writer.close();
}

double largest_difference(const std::vector<float>& a, const std::vector<float>& b) {
  double largest = 0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    const double difference = std::abs(static_cast<double>(a[k]) - static_cast<double>(b[k]));
    if (!(difference <= largest)) largest = difference;  // a NaN stays, and the report refuses it
  }
  return largest;
}

std::vector<float> to_float(const Positions& positions) {
  return {positions.data(), positions.data() + positions.size()};
}

MethodReport method_report(const ErrorStatistics& errors, double bytes_per_vertex, std::size_t coefficients) {
  MethodReport report;
  report.rms = errors.rms;
  report.p99 = errors.p99;
  report.max = errors.max;
  report.jitter = errors.jitter;
  report.frame_rms = errors.frame_rms;
  report.frame_max = errors.frame_max;
  report.bytes_per_vertex = bytes_per_vertex;
  report.coefficients = static_cast<std::uint32_t>(coefficients);
  return report;
}

// The held-out frame, of those not shown yet, in which a joint lies furthest along an axis.
std::size_t frame_of_largest(const SampleSet& set, const char* joint, int axis, const std::set<std::size_t>& shown) {
  const int index = set.character.skeleton.find(joint);
  std::size_t best = 0;
  double largest = -1e300;
  for (std::size_t k = 0; k < set.heldout.size(); ++k) {
    if (shown.contains(k)) continue;
    const Affine world =
        posed_joints(set.character.skeleton, set.heldout[k].pose.joints)[static_cast<std::size_t>(index)];
    if (world.m[axis][3] <= largest) continue;
    largest = world.m[axis][3];
    best = k;
  }
  return best;
}

class PictureMaker {
 public:
  PictureMaker(const SampleSet& set, const std::vector<Positions>& shapes, const ErrorStatistics& errors,
               const std::string& device)
      : set_(set), shapes_(shapes), errors_(errors), renderer_(device) {
    const auto* data = set.character.triangles.data();
    triangles_.assign(data, data + set.character.triangles.size());
  }

  PictureReport make(const std::string& kind, std::size_t sample, const std::string& caption) {
    constexpr std::uint32_t kWidth = 520, kHeight = 600;
    const std::vector<float> truth = to_float(set_.heldout[sample].shape.read()), result = to_float(shapes_[sample]);
    const PosePair pose{triangles_, truth, result};
    PictureReport picture;
    picture.kind = kind;
    picture.frame = set_.heldout[sample].frame;
    picture.rms_mm = errors_.frame_rms[sample];
    picture.max_mm = errors_.frame_max[sample];
    picture.heat_scale_mm = heat_scale_mm();
    picture.caption = caption;
    const Camera camera = frame_pose(pose, {-0.75f, 0.2f, 1.0f}, static_cast<float>(kWidth) / kHeight);
    picture.image = triptych(renderer_, pose, picture.heat_scale_mm, camera, kWidth, kHeight);
    return picture;
  }

 private:
  // One scale for all pictures, so that their colours can be compared; the few larger errors saturate.
  double heat_scale_mm() const { return std::max(0.5, std::ceil(4 * errors_.p99) / 2); }

  const SampleSet& set_;
  const std::vector<Positions>& shapes_;
  const ErrorStatistics& errors_;
  Renderer renderer_;
  std::vector<std::uint32_t> triangles_;
};

std::vector<PictureReport> make_pictures(const SampleSet& set, const std::vector<Positions>& shapes,
                                         const ErrorStatistics& errors, const std::string& device) {
  PictureMaker maker(set, shapes, errors, device);
  std::vector<std::size_t> order(set.heldout.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return errors.frame_rms[a] < errors.frame_rms[b]; });
  const std::size_t worst = order.back(), median = order[order.size() / 2];
  const std::size_t highest = frame_of_largest(set, "wrist", 1, {worst, median});
  const std::size_t furthest = frame_of_largest(set, "wrist", 2, {worst, median, highest});
  return {maker.make("worst", worst, "the held-out frame with the largest RMS error"),
          maker.make("median", median, "half of the held-out frames are better, half are worse"),
          maker.make("chosen", highest, "the hand at its highest"),
          maker.make("chosen", furthest, "the hand furthest forward")};
}

SimulationReport simulation_report(const Dataset& dataset) {
  SimulationReport report;
  std::vector<double> residuals;
  double iterations = 0;
  for (const DatasetTake& take : dataset.takes) {
    for (const FrameStatus& frame : read_frame_status(dataset.folder / take.shapes_status)) {
      ++report.frames;
      iterations += frame.iterations;
      if (frame.converged) residuals.push_back(frame.residual);
    }
  }
  report.converged = static_cast<std::uint32_t>(residuals.size());
  if (residuals.empty()) return report;
  std::sort(residuals.begin(), residuals.end());
  report.median_residual = residuals[residuals.size() / 2];
  report.worst_residual = residuals.back();
  report.mean_iterations = iterations / report.frames;
  return report;
}

// Of the held-out frames that converged in both.
ErrorStatistics draft_errors(const SampleSet& set, const Dataset& draft) {
  std::map<int, Positions> skins;
  for (const Sample& sample : read_samples(draft).heldout) skins[sample.frame] = sample.shape.read();
  SampleSet both = set;
  std::erase_if(both.heldout, [&](const Sample& sample) { return !skins.contains(sample.frame); });
  std::vector<Positions> shapes;
  for (const Sample& sample : both.heldout) shapes.push_back(skins.at(sample.frame));
  return heldout_errors(both, shapes);
}

// Trains `full` and `linear`, measures every method on the held-out frames, evaluates on the device and on the CPU.
ReportData measure(const DemoArguments& arguments, const fs::path& folder, const Dataset& dataset, const Dataset& draft,
                   ReportData report) {
  const SampleSet set = read_samples(dataset);
  say(set.notes);
  if (set.unconverged > 0) spdlog::warn("{} unconverged frames are left out", set.unconverged);

  Stopwatch training;
  const Basis full = train(set, {});
  say(training_warnings(full));
  save_basis(full, folder / "basis.safetensors");
  report.seconds.train = training.seconds();
  TrainOptions linear_options;
  linear_options.method = {.strains = false, .kernels = false};
  linear_options.components = 128;
  linear_options.budget = bytes_per_vertex(full);
  const Basis linear = train(set, linear_options);

  const std::vector<Pose> poses = heldout_poses(set);
  Deformer device(load_basis(folder / "basis.safetensors"), arguments.device.choice);
  Stopwatch evaluating;
  const Evaluation evaluated = device.evaluate(poses);
  report.seconds.eval = evaluating.seconds();
  write_cache(folder / "heldout.pc2", set, evaluated);
  report.device = device.device_name();
  const DeviceChoice on_cpu{.name = "cpu"};
  Deformer full_cpu(full, on_cpu), ddm_cpu(without_residual(full), on_cpu), linear_cpu(linear, on_cpu);
  report.cpu_gpu_max_difference_m = largest_difference(evaluated.positions, full_cpu.evaluate(poses).positions);

  const double vertices = static_cast<double>(set.character.vertices.rows());
  const std::vector<Positions> full_shapes = welded_shapes(set, evaluated);
  const ErrorStatistics full_errors = heldout_errors(set, full_shapes);
  const double ddm_bytes = static_cast<double>(table_bytes(full).at("ddm")) / vertices;
  report.full =
      method_report(full_errors, static_cast<double>(total_bytes(full)) / vertices, full.residual.coefficient_count());
  report.linear =
      method_report(heldout_errors(set, heldout_by_basis(set, linear_cpu)),
                    static_cast<double>(total_bytes(linear)) / vertices, linear.residual.coefficient_count());
  report.ddm = method_report(heldout_errors(set, heldout_by_basis(set, ddm_cpu)), ddm_bytes, 0);
  double weights = 0;
  for (const auto& row : set.character.weights) weights += static_cast<double>(row.size());
  report.lbs = method_report(heldout_errors(set, heldout_by_lbs(set)), 8 * weights / vertices, 0);
  const UnposingResidual unposing = unposing_residual(set, full);
  report.unposing_residual_mm.lbs = unposing.lbs;
  report.unposing_residual_mm.ddm = unposing.ddm;
  report.bytes_per_vertex = report.full.bytes_per_vertex;
  for (const auto& [stage, bytes] : table_bytes(full)) {
    report.bytes_by_stage.emplace_back(stage, static_cast<double>(bytes) / vertices);
  }

  for (const TradeOffPoint& point : read_curve(full)) {
    report.trade_off.push_back({point.bytes_per_vertex, point.expected_mm, point.microseconds, point.coefficients});
  }

  const auto box = (set.character.vertices.colwise().maxCoeff() - set.character.vertices.colwise().minCoeff()).eval();
  report.character.name = "built-in arm";
  report.character.vertices = static_cast<std::uint32_t>(set.character.vertices.rows());
  report.character.joints = static_cast<std::uint32_t>(set.character.skeleton.size());
  report.character.muscles = static_cast<std::uint32_t>(set.muscles.size());
  report.character.bounding_box_m = {box(0), box(1), box(2)};
  report.dataset.train_frames = static_cast<std::uint32_t>(set.train.size());
  report.dataset.heldout_frames = static_cast<std::uint32_t>(set.heldout.size());
  report.dataset.unconverged = static_cast<std::uint32_t>(set.unconverged);
  report.heldout_frame_numbers = heldout_frames(set);
  report.simulation = simulation_report(dataset);
  const ErrorStatistics draft_error = draft_errors(set, draft);
  report.simulation->draft_rms_mm = draft_error.rms;
  report.simulation->draft_max_mm = draft_error.max;
  if (report.device != "cpu") {
    report.pictures = make_pictures(set, full_shapes, full_errors, arguments.device.choice.name);
  } else {
    spdlog::warn("no Vulkan device: the report has no pictures");
  }
  return report;
}

std::string summary(const ReportData& report) {
  std::string text = format("%u training frames, %u held out, %s\n", report.dataset.train_frames,
                            report.dataset.heldout_frames, report.device.c_str());
  const std::pair<const char*, const MethodReport*> methods[] = {
      {"LBS", &report.lbs}, {"DDM", &report.ddm}, {"linear", &report.linear}, {"full", &report.full}};
  for (const auto& [name, method] : methods) {
    text += format("  %-7s RMS %6.3f mm  p99 %6.3f  max %7.3f  jitter %6.3f\n", name, method->rms, method->p99,
                   method->max, method->jitter);
  }
  text += format("a draft of the held-out motion: RMS %.3f mm, max %.3f, in %.0f s\n", report.simulation->draft_rms_mm,
                 report.simulation->draft_max_mm, report.seconds.draft);
  text += format("left to learn after un-posing: LBS %.3f mm, DDM %.3f mm\n", report.unposing_residual_mm.lbs,
                 report.unposing_residual_mm.ddm);
  text += format("%.0f bytes per vertex; CPU and device differ by %.2g m at most\n", report.bytes_per_vertex,
                 report.cpu_gpu_max_difference_m);
  return text;
}

void run(const DemoArguments& arguments) {
  const fs::path folder = arguments.out;
  make_folder(folder);
  arguments.json.require_writable();
  ReportData report;
  report.quick = arguments.quick;
  Stopwatch building;
  const DemoSize& size = arguments.quick ? kQuick : kFull;
  write_inputs(folder, size);
  report.seconds.build_character = building.seconds();
  Stopwatch simulating;
  const Dataset dataset = simulate_dataset(folder, size);
  report.seconds.simulate = simulating.seconds();
  Stopwatch drafting;
  const Dataset draft = simulate_draft(folder, size);
  report.seconds.draft = drafting.seconds();
  report = measure(arguments, folder, dataset, draft, report);
  report.peak_memory_mib = peak_memory_mib();
  write_report(report, folder);

  std::ifstream json(folder / "report.json");
  arguments.json.emit(Json::parse(json), summary(report) + "wrote " + (folder / "report.html").string() + "\n");
}

}  // namespace

void add_demo(CLI::App& app) {
  auto arguments = std::make_shared<DemoArguments>();
  CLI::App& verb = *app.add_subcommand("demo", "The whole path on the built-in arm, from character to report");
  verb.add_option("--out", arguments->out, "Folder for everything that is made")->required()->type_name("DIR");
  verb.add_flag("--quick", arguments->quick, "A few of the frames: to see it work, not to judge the errors");
  arguments->device.add(verb);
  arguments->json.add(verb);
  verb.callback([arguments] { run(*arguments); });
}

}  // namespace bodyopt::cli
