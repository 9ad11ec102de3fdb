// bodyopt train: a dataset to a basis.
#include "trainer/train/fit/train.h"

#include <spdlog/spdlog.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "assets/clips/clip_source.h"
#include "cli/arguments/common.h"
#include "cli/range_dataset.h"
#include "cli/results/attachments.h"
#include "cli/results/measure.h"
#include "cli/results/report_pictures.h"
#include "runtime/core/error.h"
#include "runtime/core/json.h"
#include "runtime/core/stopwatch.h"
#include "runtime/core/transformed.h"
#include "runtime/deformer/deformer.h"
#include "trainer/check/check.h"
#include "trainer/motion/held_turns.h"
#include "trainer/simulate/simulate.h"
#include "trainer/train/data/samples.h"
#include "trainer/train/fit/choose_map.h"
#include "trainer/train/judge/test_errors.h"
#include "trainer/train/options.h"
#include "trainer/train/pack/trade_off.h"
#include "trainer/train/skinning/ddm.h"
#include "trainer/train/skinning/provenance.h"

namespace bodyopt::cli {
namespace {

struct TrainArguments {
  std::string dataset, ddm_only, out, report;
  RangeDatasetArguments range;
  double unit = 0;
  int heldout_every = 0;
  std::optional<int> surface_curves;
  bool ablate = false;
  trainer::TrainOptions options;
  JsonOption json;
};

void run_ddm_only(const TrainArguments& arguments) {
  const Character character = read_character(arguments.ddm_only, arguments.unit);
  say(character.notes);
  Basis basis = trainer::build_ddm_basis(character, arguments.options);
  keep_unit(basis, character.unit);
  save_basis(basis, arguments.out);
  const std::vector<AttachedMesh> attached =
      attach_own_meshes(arguments.ddm_only, character.unit, character.output_count(), basis, arguments.out);
  const double per_vertex = trainer::bytes_per_vertex(basis);
  arguments.json.emit(
      {{"basis", arguments.out},
       {"vertices", basis.mesh.vertex_count()},
       {"bytes_per_vertex", per_vertex},
       {"attached", to_json(attached)}},
      describe(attached) + format("wrote {}: Direct Delta Mush of {} vertices, {:.0f} bytes per vertex\n",
                                  arguments.out, basis.mesh.vertex_count(), per_vertex));
}

Json ablation(const std::vector<MethodResult>& methods) {
  return transformed(methods, [](const MethodResult& method) {
    Json entry = {{"method", method.name}};
    entry.update(to_json(method));
    return entry;
  });
}

Json result_of(const TrainArguments& arguments, const trainer::SampleSet& set, const Training& training,
               const std::vector<AttachedMesh>& attached, double seconds) {
  Json result = {{"basis", arguments.out},
                 {"train_frames", set.train.size()},
                 {"heldout_frames", set.heldout.size()},
                 {"unconverged_frames", set.unconverged},
                 {"bytes_per_vertex", trainer::bytes_per_vertex(training.result.basis)},
                 {"expected_rms_mm", training.result.expected_mm},
                 {"warnings", training.result.warnings},
                 {"unposing_residual_mm", {{"lbs", training.unposing.lbs}, {"ddm", training.unposing.ddm}}},
                 {"attached", to_json(attached)},
                 {"seconds", seconds}};
  if (set.heldout.empty()) return result;
  result["errors_mm"] = {{"lbs", to_json(training.methods[0].errors)},
                         {"ddm", to_json(training.methods[1].errors)},
                         {"full", to_json(training.methods.back().errors)}};
  if (arguments.ablate) result["ablation"] = ablation(training.methods);
  return result;
}

// The line of Direct Delta Mush says how far it smooths.
std::string heldout_table(const Training& training) {
  std::vector<MethodResult> methods = training.methods;
  methods[1].name += format(", smoothing radius {:.0f} mm", 1e3 * training.result.smoothing_radius);
  return method_table(methods);
}

std::string train_text(const trainer::SampleSet& set, const Training& training, double seconds) {
  std::string text = format(
      "trained on {} frames ({} unconverged left out) in {:.1f} s: {:.0f} bytes per vertex, {:.3f} mm RMS expected of poses "
      "near those trained on\n",
      set.train.size(), set.unconverged, seconds, trainer::bytes_per_vertex(training.result.basis),
      training.result.expected_mm);
  text += format("left to learn after un-posing: LBS {:.3f} mm, DDM {:.3f} mm RMS\n", training.unposing.lbs,
                 training.unposing.ddm);
  if (!set.heldout.empty()) {
    text += format("held out, {} frames:\n", set.heldout.size()) + heldout_table(training);
  }
  return text;
}

// `path`: the dataset.json.
void report(const TrainArguments& arguments, const Dataset& dataset, const std::filesystem::path& path,
            const trainer::SampleSet& set, const Training& training) {
  const bool has_pictures = has_vulkan_device();
  if (!has_pictures) spdlog::warn("no Vulkan device: the report has no pictures");
  Deformer full(training.result.basis, {.name = "cpu"});
  report::ReportData data = report_of(set, training, trainer::heldout_by_basis(set, full), has_pictures ? "auto" : "");
  if (has_pictures) data.sections = section_pictures(set, trainer::anatomy_options(dataset, set.character.skeleton));
  data.device = full.device_name();
  data.character.name = std::filesystem::path(dataset.character).stem().string();
  data.provenance = provenance_of(dataset, path, set, arguments.options, arguments.out);
  report::write_report(data, arguments.report);
}

// The number is as asked, in an update as the earlier training had it, or else as many as are needed.
int surface_curves_for(const TrainArguments& arguments, const trainer::SampleSet& set) {
  if (arguments.surface_curves) return *arguments.surface_curves;
  if (arguments.options.update && std::filesystem::exists(arguments.out)) {
    const auto earlier = trainer::read_provenance(load_basis(arguments.out).metadata, arguments.out);
    if (earlier) return earlier->options.surface_curves;
  }
  const int pairs = trainer::needed_surface_curves(set, arguments.options);
  if (pairs > 0) {
    spdlog::info(
        "joints tell little of how the skin moves, and there are no muscles: strains are measured along {} pairs of "
        "curves on the skin (--surface-curves)",
        pairs);
  }
  return pairs;
}

// The dataset given, or one that is made for the character given.
std::string dataset_of(const TrainArguments& arguments) {
  const bool character = is_called_scene(arguments.dataset);
  const std::filesystem::path given = arguments.dataset;
  if (!character && std::filesystem::is_directory(given) && !std::filesystem::exists(dataset_file(given))) {
    throw Error(ErrorKind::file, given,
                ": there is no dataset.json in it: expected a dataset's folder, or a character ",
                "(.glb, .gltf, .fbx)");
  }
  if (!character && arguments.range.any()) {
    read_dataset(dataset_file(given));  // of what is none, it says so
    throw Error(
        ErrorKind::usage, arguments.dataset,
        " is a dataset: --data, --clip, --limits, --muscles, --minutes, --no-range, --fps, --joint-map and --up "
        "go with a character (.glb, .gltf, .fbx), of which train makes one");
  }
  if (!character) return arguments.dataset;
  if (arguments.ablate && arguments.heldout_every == 0) {
    throw Error(ErrorKind::usage, "--ablate compares methods on held-out frames: of a character give --heldout-every");
  }
  RangeDatasetArguments range = arguments.range;
  if (range.folder.empty()) range.folder = std::filesystem::path(arguments.out).replace_extension(".data").string();
  return make_range_dataset(arguments.dataset, arguments.unit, range).string();
}

// `path`: the dataset.json. Throws Error(mismatch) where its files do not belong together.
Dataset checked_dataset(const TrainArguments& arguments, const std::filesystem::path& path) {
  Dataset dataset = read_dataset(path);
  spdlog::info("checking that shapes, clips and character belong together");
  const std::string mismatch = trainer::first_problem(trainer::check_dataset(dataset), path);
  if (!mismatch.empty()) throw Error(ErrorKind::mismatch, mismatch);
  if (arguments.heldout_every > 0) trainer::hold_out_blocks(dataset, arguments.heldout_every);
  return dataset;
}

// Says what the user should know of them.
trainer::SampleSet samples_of(const TrainArguments& arguments, const Dataset& dataset) {
  spdlog::info("reading the shapes");
  trainer::SampleSet set = trainer::read_samples(dataset);
  say(set.notes);
  if (arguments.ablate && set.heldout.empty()) {
    throw Error(ErrorKind::usage,
                "--ablate compares methods on held-out frames, and there are none: ", trainer::how_to_hold_out(set));
  }
  const std::string coupled =
      describe(trainer::coupled_joints(set.character.skeleton, trainer::training_poses(set)), set.character.skeleton);
  if (!coupled.empty()) say({coupled});
  if (arguments.heldout_every > 0 && set.heldout.empty()) {
    spdlog::warn("--heldout-every {} holds out none of the frames: {}", arguments.heldout_every,
                 trainer::how_to_hold_out(set));
  }
  if (set.unconverged > 0) spdlog::warn("{} unconverged frames are left out", set.unconverged);
  return set;
}

void warn_of_no_gain(const Training& training) {
  if (training.methods.back().errors.rms < training.methods[1].errors.rms) return;
  spdlog::warn(
      "what was learned is no better than Direct Delta Mush on the held-out frames: the training frames are "
      "too few, or too unlike them");
}

// Held-out errors far above the expected one are of other poses.
void warn_of_far_frames(const Training& training) {
  constexpr double kFar = 2;
  const double measured = training.methods.back().errors.rms, expected = training.result.expected_mm;
  if (!(measured > kFar * expected)) return;
  spdlog::warn(
      "the held-out frames are off by {:.3f} mm RMS, and {:.3f} mm are expected of poses near those trained on: they "
      "are further away, or the training frames are too few; of such poses believe what was measured",
      measured, expected);
}

void require_tolerance(const TrainArguments& arguments, double expected) {
  const double tolerance = arguments.options.tolerance_mm;
  if (!(tolerance > 0 && expected > tolerance)) return;
  throw Error(ErrorKind::quality, format("{}: {:.3g} mm RMS were asked for, and {:.3f} are to be expected of the best "
                                         "basis that these frames give, which was written: more frames, or muscles "
                                         "that the skin lacks, may lower that",
                                         arguments.out, tolerance, expected));
}

void run(TrainArguments arguments) {
  if (arguments.dataset.empty() == arguments.ddm_only.empty()) {
    throw Error(ErrorKind::usage, "train takes a DATASET, a CHARACTER, or --ddm-only CHARACTER");
  }
  if (!arguments.ddm_only.empty() && arguments.range.any()) {
    throw Error(ErrorKind::usage, "--ddm-only simulates nothing: leave out what says what to simulate");
  }
  require_writable(arguments.out);
  arguments.json.require_writable();
  if (!arguments.ddm_only.empty()) return run_ddm_only(arguments);
  if (!arguments.report.empty()) make_folder(arguments.report);
  arguments.options.keep_in = std::filesystem::path(arguments.out).replace_extension(".training");

  const std::filesystem::path path = dataset_file(dataset_of(arguments));
  const Stopwatch watch;
  const Dataset dataset = checked_dataset(arguments, path);
  const trainer::SampleSet set = samples_of(arguments, dataset);
  arguments.options.surface_curves = surface_curves_for(arguments, set);
  const double preparing = watch.seconds();
  const Training training =
      train_and_measure(set, arguments.options, arguments.ablate, set.character.unit, arguments.out);
  const std::vector<AttachedMesh> attached =
      attach_own_meshes(dataset.folder / dataset.character, set.character.unit, set.character.output_count(),
                        training.result.basis, arguments.out);
  const double seconds = preparing + training.seconds;

  const Json result = result_of(arguments, set, training, attached, seconds);
  std::string text = train_text(set, training, seconds);
  if (!set.heldout.empty()) {
    warn_of_no_gain(training);
    warn_of_far_frames(training);
  }
  if (!arguments.report.empty()) {
    report(arguments, dataset, path, set, training);
    text += "wrote " + (std::filesystem::path(arguments.report) / "report.html").string() + "\n";
  }
  text += describe(attached) + "wrote " + arguments.out + "\n";
  arguments.json.emit(result, text);
  require_tolerance(arguments, training.result.expected_mm);
}

}  // namespace

void add_train(CLI::App& app) {
  const auto [verb, arguments] = add_verb<TrainArguments, TrainArguments>(
      app, "train", "Learn a basis from a dataset, or from a character alone", run);
  add_option(
      verb, "dataset", arguments.dataset,
      "dataset.json, or its folder; or a character (.glb, .gltf, .fbx): drafts of its range of motion and of its "
      "clips are made first")
      ->type_name("DATASET|CHARACTER");
  CLI::Option* ddm_only =
      add_option(verb, "--ddm-only", arguments.ddm_only, "Make a basis of Direct Delta Mush alone, without shapes")
          ->type_name("CHARACTER");
  add_option(verb, "--out", arguments.out, "FILE.safetensors", "Basis to write")->required();
  arguments.range.add(verb);
  add_option(verb, "--heldout-every", arguments.heldout_every,
             "Hold out every Nth block of ten frames instead of the frames dataset.json names")
      ->check(CLI::Range(2, 1000));
  add_option(verb, "--surface-curves", arguments.surface_curves,
             "Also measure strains along so many pairs of curves on the skin, where nothing explains its motion "
             "(default: 40 of few frames without muscles of which joints tell little, else 0)")
      ->type_name("N")
      ->check(CLI::Range(0, 1000))
      ->excludes(ddm_only);
  add_flag(verb, "--update", arguments.options.update,
           "Learn new and edited frames with the regions, components and hyper-parameters that an earlier training "
           "to the same file found: several times quicker")
      ->excludes(ddm_only);
  add_flag(verb, "--ablate", arguments.ablate,
           "Also train the model with parts left out, and its peers, to as many bytes, and compare them");
  add_option(verb, "--report", arguments.report, "DIR",
             "Folder for report.html and report.json: what was learned, and how well")
      ->excludes(ddm_only);
  add_option(
      verb, "--smoothing-radius", arguments.options.smoothing_radius,
      "Radius of Direct Delta Mush, metres (default: 1/40 of the size, twice that where it leaves less to learn, "
      "or down to a sixteenth of it where linear blending does)")
      ->check(above_zero);
  CLI::Option* budget = add_option(verb, "--budget", arguments.options.budget,
                                   "The best basis of so many bytes per vertex at most, all tables together");
  budget->type_name("BYTES")->check(above_zero)->excludes(ddm_only);
  add_option(verb, "--tolerance", arguments.options.tolerance_mm,
             "The smallest basis with an expected RMS error of so many mm at most")
      ->type_name("MM")
      ->check(above_zero)
      ->excludes(ddm_only)
      ->excludes(budget);
  add_number(verb, "--components", arguments.options.components, 1, 256, "Coefficients per region at most");
  add_number(verb, "--centres", arguments.options.centres, 0, 4096, "Kernel centres per region at most");
  add_number(verb, "--memory", arguments.options.memory_gib, 1e-6, 1e6,
             "GiB that shapes in memory may take; with less, they are read several times");
  add_option(verb, "--seed", arguments.options.seed, "Seed of every random choice")->capture_default_str();
  add_unit(verb, arguments.unit);
  arguments.json.add(verb);
}

}  // namespace bodyopt::cli
