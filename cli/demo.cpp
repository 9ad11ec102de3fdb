// bodyopt demo: the main job on the built-in arm, from character to report.
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "assets/caches/pc2.h"
#include "base/json_file.h"
#include "cli/arguments/common.h"
#include "cli/arguments/dataset_arguments.h"
#include "cli/results/demo_extras.h"
#include "cli/results/measure.h"
#include "cli/results/report_pictures.h"
#include "runtime/core/error.h"
#include "runtime/core/stopwatch.h"
#include "runtime/core/transformed.h"
#include "runtime/host/rig.h"
#include "trainer/builtin/arm.h"
#include "trainer/motion/range_of_motion.h"
#include "trainer/simulate/simulate.h"

namespace bodyopt::cli {
namespace {

namespace fs = std::filesystem;

struct DemoArguments {
  std::string out;
  bool quick = false, all = false;
  DeviceArguments device;
  JsonOption json;
};

struct DemoSize {
  int rom_frames, heldout_frames;
};
constexpr DemoSize kFull{190, 144}, kQuick{48, 24};
// Every Nth frame of the range of motion is also simulated with muscles flexed.
constexpr int kFlexedStep = 10;
// Simulating every third frame of the held-out motion shows its whole arc at a third of the cost.
constexpr int kHeldoutStep = 3;
// The first arm to look at is learned from drafts of every Nth frame of the range of motion.
constexpr int kDraftStep = 3;

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

// Chest and upper arm wobble in some six frames a swing, slow enough to be seen; firm at the elbow, held from the wrist
// on.
void write_jiggle(const fs::path& path) {
  Json regions = {{{"joint", "torso"}, {"softness", 5}, {"damping", 0.15}, {"flesh", 0.06}},
                  {{"joint", "clavicle"}, {"softness", 4}, {"damping", 0.15}, {"flesh", 0.05}},
                  {{"joint", "shoulder"}, {"softness", 3}, {"damping", 0.15}, {"flesh", 0.05}},
                  {{"joint", "elbow"}, {"softness", 0.4}, {"amount", 0.5}},
                  {{"joint", "forearm"}, {"amount", 0.3}}};
  for (const char* held : {"forearm_twist", "wrist", "finger*", "thumb"}) {
    regions.push_back({{"joint", held}, {"amount", 0}});
  }
  write_json({{"schema", "bodyopt-jiggle-1"}, {"regions", regions}}, path);
}

// The files a user would bring: character, muscles, limits, three clips and how muscles flex in one of them.
void write_inputs(const fs::path& folder, const DemoSize& size) {
  const trainer::BuiltinArm arm = trainer::build_arm();
  const Skeleton& skeleton = arm.character.skeleton;
  write_character(arm.character, folder / "character.glb");
  write_muscles(arm.muscles, skeleton, folder / "muscles.json");
  const trainer::JointLimits limits = trainer::arm_limits(skeleton);
  trainer::write_joint_limits(limits, skeleton, folder / "limits.json");
  const trainer::RangeOfMotion motion = trainer::range_of_motion(arm.character, limits, {.frames = size.rom_frames});
  write_clip(trainer::clip_of(motion, limits, skeleton), skeleton, folder / "rom.glb");
  write_flex(folder / "flex.json", size.rom_frames);
  write_clip(trainer::arm_heldout(skeleton, size.heldout_frames), skeleton, folder / "heldout.glb");
  write_clip(trainer::arm_stop(skeleton), skeleton, folder / "stop.glb");
  write_jiggle(folder / "jiggle.json");
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
  fs::create_directories(folder);
  dataset.folder = folder;
  dataset.character = "../character.glb";
  dataset.muscles = "../muscles.json";
  return dataset;
}

// The command that shows a basis in the viewport, by this program, wherever it lies.
std::string to_view(const fs::path& folder, const char* basis) {
  return "  " + fs::proximate(fs::read_symlink("/proc/self/exe")).string() + " view " + (folder / basis).string() +
         " " + (folder / "heldout.glb").string() + "\n";
}

PreparedBody body_of(const Dataset& dataset, const trainer::SimulateOptions& options) {
  Character character = read_character(dataset.folder / dataset.character);
  std::vector<Muscle> muscles = read_muscles(dataset.folder / dataset.muscles, character.skeleton);
  return {std::move(character), std::move(muscles), options};
}

void add_take(const PreparedBody& body, const DatasetTake& take, const trainer::SimulateOptions& options,
              Dataset& dataset) {
  trainer::simulate(body.body, body.character, body.muscles, read_clip(dataset, take, body.character.skeleton),
                    take.frames, dataset.folder / take.shapes, dataset.folder / take.shapes_status, options);
  dataset.takes.push_back(take);
  write_dataset(dataset, dataset.folder / "dataset.json");
}

DatasetTake heldout_take(const DemoSize& size) {
  const std::vector<int> frames = every(kHeldoutStep, size.heldout_frames);
  DatasetTake take = take_of("heldout", "heldout.glb", frames);
  take.heldout = frames;
  return take;
}

Dataset simulate_dataset(const fs::path& folder, const DemoSize& size) {
  Dataset dataset = dataset_in(folder / "dataset");
  const PreparedBody body = body_of(dataset, {});
  add_take(body, take_of("rom", "rom.glb", every(1, size.rom_frames)), {}, dataset);
  DatasetTake flexed = take_of("flexed", "rom.glb", every(kFlexedStep, size.rom_frames));
  flexed.controls = "../flex.json";
  add_take(body, flexed, {}, dataset);
  add_take(body, heldout_take(size), {}, dataset);
  return dataset;
}

// Drafts of the range of motion, from which a first arm is learned to look at while the full simulation runs; then of
// the held-out motion, which are held against that. Returns their dataset.
Dataset simulate_drafts(const fs::path& folder, const DemoSize& size, const DemoArguments& arguments) {
  Dataset dataset = dataset_in(folder / "draft");
  const trainer::SimulateOptions options{.draft = true};
  const PreparedBody body = body_of(dataset, options);
  DatasetTake rom = take_of("rom", "rom.glb", every(kDraftStep, size.rom_frames)), heldout = heldout_take(size);
  for (DatasetTake* take : {&rom, &heldout}) take->shapes = take->name + ".nodes";
  add_take(body, rom, options, dataset);
  train_and_measure(trainer::read_samples(dataset), {}, false, 0, folder / "first.safetensors");
  arguments.json.print("a first arm, learned from drafts, can be looked at:\n" + to_view(folder, "first.safetensors"));
  add_take(body, heldout, options, dataset);
  return dataset;
}

std::vector<Positions> welded_shapes(const trainer::SampleSet& set, const Evaluation& evaluation) {
  std::vector<Positions> shapes;
  const std::size_t stride = 3 * std::size_t{set.character.output_count()};
  for (std::size_t k = 0; k < set.heldout.size(); ++k) {
    shapes.push_back(welded_from_output(set.character, evaluation.positions.data() + k * stride));
  }
  return shapes;
}

void write_evaluation(const fs::path& path, const trainer::SampleSet& set, const Evaluation& evaluation) {
  const std::vector<int> frames = transformed(set.heldout, &trainer::Sample::frame);
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

// The held-out frame, of those not shown yet, in which a joint lies furthest along an axis.
std::size_t frame_of_largest(const trainer::SampleSet& set, const char* joint, int axis,
                             const std::set<std::size_t>& shown) {
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

// Two poses that show what the arm can do.
void add_chosen_pictures(const trainer::SampleSet& set, const std::vector<Positions>& shapes, const Basis& basis,
                         const std::string& device, report::ReportData& report) {
  ReportPictures pictures(set, shapes, report.methods.back().errors, basis, device);
  const std::vector<std::size_t> order = by_error(report.methods.back().errors);
  const std::size_t worst = order.back(), median = order[order.size() / 2];
  const std::size_t highest = frame_of_largest(set, "wrist", 1, {worst, median});
  const std::size_t furthest = frame_of_largest(set, "wrist", 2, {worst, median, highest});
  report.pictures.push_back(pictures.frame("chosen", highest, "the hand at its highest"));
  report.pictures.push_back(pictures.frame("chosen", furthest, "the hand furthest forward"));
}

void describe_simulation(const Dataset& dataset, report::DemoReport& report) {
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
  if (residuals.empty()) return;
  std::sort(residuals.begin(), residuals.end());
  report.median_residual = residuals[residuals.size() / 2];
  report.worst_residual = residuals.back();
  report.mean_iterations = iterations / report.frames;
}

// Errors on the held-out frames that converged in both.
ErrorStatistics draft_errors(const trainer::SampleSet& set, const Dataset& draft) {
  std::map<int, Positions> skins;
  for (const trainer::Sample& sample : trainer::read_samples(draft).heldout) skins[sample.frame] = sample.shape.read();
  std::vector<trainer::Sample> both = set.heldout;
  std::erase_if(both, [&](const trainer::Sample& sample) { return !skins.contains(sample.frame); });
  std::vector<Positions> shapes;
  for (const trainer::Sample& sample : both) shapes.push_back(skins.at(sample.frame));
  return trainer::heldout_errors(both, shapes);
}

// Trains, holds the basis against its peers, evaluates the held-out frames on the device and on the CPU.
report::ReportData measure(const DemoArguments& arguments, const fs::path& folder, const Dataset& dataset,
                           const Dataset& draft, report::DemoReport demo) {
  const trainer::SampleSet set = trainer::read_samples(dataset);
  say(set.notes);
  if (set.unconverged > 0) spdlog::warn("{} unconverged frames are left out", set.unconverged);
  const fs::path basis_file = folder / "basis.safetensors";
  const Training training = train_and_measure(set, {}, arguments.all, 0, basis_file);

  const std::vector<Pose> poses = heldout_poses(set);
  Deformer device(load_basis(basis_file), arguments.device.choice);
  Stopwatch evaluating;
  const Evaluation evaluated = device.evaluate(poses);
  demo.seconds.eval = evaluating.seconds();
  write_evaluation(folder / "heldout.pc2", set, evaluated);
  Deformer on_cpu(training.result.basis, {.name = "cpu"});
  demo.cpu_gpu_max_difference_m = largest_difference(evaluated.positions, on_cpu.evaluate(poses).positions);

  describe_simulation(dataset, demo);
  const ErrorStatistics draft_error = draft_errors(set, draft);
  demo.draft_rms_mm = draft_error.rms;
  demo.draft_max_mm = draft_error.max;

  const bool has_pictures = device.device_name() != "cpu";
  if (!has_pictures) spdlog::warn("no Vulkan device: the report has no pictures");
  const std::vector<Positions> shapes = welded_shapes(set, evaluated);
  const std::string pictures_on = has_pictures ? arguments.device.choice.name : "";
  report::ReportData report = report_of(set, training, shapes, pictures_on);
  if (has_pictures) {
    add_chosen_pictures(set, shapes, training.result.basis, pictures_on, report);
    report.sections = section_pictures(set, trainer::anatomy_options(dataset, set.character.skeleton));
  }
  if (arguments.all) {
    report.jiggle = demo_jiggle(set, training.result.basis, arguments.device.choice, pictures_on, folder);
  }
  report.character.name = "built-in arm";
  report.device = device.device_name();
  report.provenance = provenance_of(dataset, dataset.folder / "dataset.json", set, {}, basis_file);
  report.demo = demo;
  return report;
}

std::string summary(const report::ReportData& report) {
  std::string text = format("{} training frames, {} held out, {}\n", report.dataset.train_frames,
                            report.dataset.heldout_frames, report.device);
  text += method_table(report.methods);
  text += format("a draft of the held-out motion: RMS {:.3f} mm, max {:.3f}, in {:.0f} s\n", report.demo->draft_rms_mm,
                 report.demo->draft_max_mm, report.demo->seconds.draft);
  text += format("left to learn after un-posing: LBS {:.3f} mm, DDM {:.3f} mm\n", report.unposing_residual_mm.lbs,
                 report.unposing_residual_mm.ddm);
  text += format("{:.0f} bytes per vertex; CPU and device differ by {:.2g} m at most\n", report.bytes_per_vertex,
                 report.demo->cpu_gpu_max_difference_m);
  return text;
}

void run(DemoArguments arguments) {
  // It draws, and holds a Vulkan device against the CPU: a software one will do.
  DeviceChoice& device = arguments.device.choice;
  if (device.name == "auto" && has_vulkan_device()) device.require_device = true;
  const fs::path folder = arguments.out;
  make_folder(folder);
  arguments.json.require_writable();
  report::DemoReport demo;
  demo.quick = arguments.quick;
  Stopwatch building;
  const DemoSize& size = arguments.quick ? kQuick : kFull;
  write_inputs(folder, size);
  demo.seconds.build_character = building.seconds();
  Stopwatch drafting;
  const Dataset draft = simulate_drafts(folder, size, arguments);
  demo.seconds.draft = drafting.seconds();
  Stopwatch simulating;
  const Dataset dataset = simulate_dataset(folder, size);
  demo.seconds.simulate = simulating.seconds();
  const report::ReportData report = measure(arguments, folder, dataset, draft, demo);
  const Json written = report::write_report(report, folder);
  const std::string carried = arguments.all ? demo_transfer(folder, report.device != "cpu") : "";
  arguments.json.emit(written, summary(report) + carried + "wrote " + (folder / "report.html").string() +
                                   "\nthe arm in the viewport:\n" + to_view(folder, "basis.safetensors"));
}

}  // namespace

void add_demo(CLI::App& app) {
  const auto [verb, arguments] = add_verb<DemoArguments, DemoArguments>(
      app, "demo", "Do the whole path on the built-in arm, from character to report", run);
  add_required(verb, "--out", arguments.out, "DIR", "Folder for everything that is made");
  add_flag(verb, "--quick", arguments.quick, "A few of the frames: to see it work, not to judge the errors");
  add_flag(verb, "--all", arguments.all, "Also the other methods on the same frames, jiggle, and a stockier arm");
  arguments.device.add(verb);
  arguments.json.add(verb);
}

}  // namespace bodyopt::cli
