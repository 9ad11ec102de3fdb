// bodyopt dynamics: the tables of diffuse and jiggle for a trained basis.

#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "assets/clips/clip_source.h"
#include "assets/clips/controls.h"
#include "base/json_file.h"
#include "base/written_over.h"
#include "cli/arguments/common.h"
#include "dataset/dataset.h"
#include "dataset/regions_file.h"
#include "runtime/core/error.h"
#include "runtime/core/stopwatch.h"
#include "trainer/dynamics/build_dynamics.h"
#include "trainer/simulate/simulate.h"

namespace bodyopt::cli {
namespace {

struct DynamicsArguments {
  std::string dataset, basis, out, jiggle, jiggle_out;
  trainer::DynamicsOptions options;
  JsonOption json;
};

// Poses of the frames that the basis may know.
std::vector<Pose> training_poses(const Dataset& dataset, const Basis& basis) {
  std::vector<Pose> poses;
  for (const DatasetTake& take : dataset.takes) {
    Clip clip = read_clip(dataset, take, basis.skeleton);
    arrange_controls(basis.residual.controls, clip);
    const std::set<int> heldout(take.heldout.begin(), take.heldout.end());
    std::vector<int> frames;
    for (const int frame : take.frames) {
      if (frame < clip.first_frame || frame > clip.last_frame()) {
        throw Error(ErrorKind::mismatch,
                    format("take '{}': frame {} is not in the clip {}, which has frames {} to {}: first_frame or fps "
                           "may be wrong",
                           take.name, frame, take.clip, clip.first_frame, clip.last_frame()));
      }
      if (!heldout.contains(frame)) frames.push_back(frame);
    }
    const std::vector<Pose> more = shots::poses_of(clip, frames);
    poses.insert(poses.end(), more.begin(), more.end());
  }
  return poses;
}

trainer::BuiltDynamics build(DynamicsArguments& arguments, const Basis& basis) {
  trainer::DynamicsOptions& options = arguments.options;
  if (is_called_scene(arguments.dataset)) {
    const Character character = read_character(arguments.dataset, kept_unit(basis));
    say(character.notes);
    return trainer::build_dynamics(character, {}, basis, options);
  }
  const std::filesystem::path path = dataset_file(arguments.dataset);
  const Dataset dataset = read_dataset(path);
  const Character character = read_character(dataset.folder / dataset.character, dataset.unit);
  say(character.notes);
  std::vector<Muscle> muscles;
  if (!dataset.muscles.empty()) muscles = read_muscles(dataset.folder / dataset.muscles, character.skeleton);
  if (!dataset.materials.empty()) options.materials = trainer::read_materials(dataset.folder / dataset.materials);
  options.anatomy = trainer::anatomy_options(dataset, character.skeleton);
  options.painted = read_regions(dataset, character);
  options.poses = training_poses(dataset, basis);
  return trainer::build_dynamics(character, muscles, basis, options);
}

void run(DynamicsArguments arguments) {
  require_writable(arguments.out);
  if (!arguments.jiggle_out.empty()) {
    refuse_over("--jiggle-out", arguments.jiggle_out, {dataset_file(arguments.dataset), arguments.jiggle});
    trainer::require_replaceable_jiggle(arguments.jiggle_out);
    require_writable(arguments.jiggle_out);
  }
  arguments.json.require_writable();
  refuse_overwriting(arguments.out, arguments.basis);
  const Stopwatch watch;
  const Basis basis = load_basis(arguments.basis);
  if (!arguments.jiggle.empty()) arguments.options.settings = trainer::read_jiggle(arguments.jiggle);
  const trainer::BuiltDynamics built = build(arguments, basis);
  const Dynamics& dynamics = built.dynamics;
  validate(dynamics, basis, "the dynamics to be saved");
  save_dynamics(dynamics, arguments.out);
  if (!arguments.jiggle_out.empty()) write_json(trainer::jiggle_json(built.settings), arguments.jiggle_out);
  const double seconds = watch.seconds();

  const trainer::DynamicsReport& report = built.report;
  say(report.notes);
  Json result = {{"dynamics", arguments.out}};
  result.update(trainer::to_json(report));
  for (const auto& [stage, bytes] : table_bytes(dynamics)) result["bytes"][stage] = bytes;
  result["seconds"] = seconds;
  const auto megabytes = [&](const char* stage) { return result["bytes"][stage].get<double>() / 1e6; };
  arguments.json.emit(
      result,
      format(
          "{} tetrahedra, {} nodes, {} of them on the skin; quality {:.2f} at worst, first percentile {:.2f}, median "
          "{:.2f}\n{} springs hold them to the bones of {} joints\n",
          report.tets, report.nodes, report.surface_nodes, report.quality.worst, report.quality.first_percentile,
          report.quality.median, report.bone_springs, report.joints_with_bones) +
          format("wrote {}: diffuse {:.1f} MB, jiggle {:.1f} MB, in {:.1f} s\n", arguments.out, megabytes("diffuse"),
                 megabytes("jiggle"), seconds));
}

}  // namespace

void add_dynamics(CLI::App& app) {
  const auto [verb, arguments] = add_verb<DynamicsArguments, DynamicsArguments>(
      app, "dynamics", "Make what lets a trained character's tissue jiggle: a second file beside its basis", run);
  trainer::DynamicsOptions& options = arguments.options;
  add_required(verb, "dataset", arguments.dataset, "DATASET",
               "dataset.json, or its folder; or the character alone, whose muscles then do not stiffen");
  add_required(verb, "--basis", arguments.basis, "BASIS", "The basis trained from it");
  add_option(verb, "--out", arguments.out, "FILE.safetensors", "Dynamics to write")->required();
  add_option(verb, "--jiggle", arguments.jiggle, "FILE",
             "How soft, damped and free tissue is, and where (jiggle.json)");
  add_option(verb, "--jiggle-out", arguments.jiggle_out, "FILE.json",
             "Write the settings it chose, to edit (jiggle.json)");
  add_number(verb, "--dynamics-resolution", options.resolution, 100, 1000000, "Tetrahedra at most");
  add_number(verb, "--fps", options.step.frames_per_second, kLeastRate, kMostRate,
             "Frames a second of the clips to come");
  add_number(verb, "--substeps", options.step.substeps, 1, 64, "Steps a frame");
  add_former_option(verb, "--integrator", "all dynamics step by TR-BDF2");
  arguments.json.add(verb);
}

}  // namespace bodyopt::cli
