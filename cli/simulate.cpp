// bodyopt simulate: a character and a clip to shapes by finite elements.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "cli/arguments/common.h"
#include "cli/arguments/dataset_arguments.h"
#include "trainer/check/shape_doubts.h"

namespace bodyopt::cli {
namespace {

namespace fs = std::filesystem;

struct SimulateArguments : SimulationArguments {
  JsonOption json;
};

// Metres of skin in skin that are worth a look.
constexpr double kDeep = 5e-3;

// Facts of a run that a TD has to know; `text` names the frames that need a look.
Json summary(const std::vector<FrameStatus>& status, std::string& text) {
  int unconverged = 0, inverted = 0, deep = 0;
  double residual = 0, seconds = 0, depth = 0, volume = 0, error = 0;
  int deepest_frame = 0;
  Json per_frame = Json::array();
  for (const FrameStatus& frame : status) {
    if (frame.converged) {
      residual = std::max(residual, frame.residual);
    } else {
      ++unconverged;
      text += format("frame {} did not converge (residual {:.2e}, {} inverted tets): train will leave it out\n",
                     frame.frame, frame.residual, frame.inverted_tets);
    }
    inverted += frame.inverted_tets;
    seconds += frame.seconds;
    deep += frame.contact_depth > kDeep ? 1 : 0;
    if (frame.contact_depth > depth) {
      depth = frame.contact_depth;
      deepest_frame = frame.frame;
    }
    if (std::abs(frame.volume_change) > std::abs(volume)) volume = frame.volume_change;
    per_frame.push_back({{"frame", frame.frame},
                         {"residual", frame.residual},
                         {"converged", frame.converged},
                         {"iterations", frame.iterations},
                         {"inverted_tets", frame.inverted_tets},
                         {"contact_depth_mm", 1e3 * frame.contact_depth},
                         {"volume_change", frame.volume_change}});
    if (std::isfinite(frame.discretisation_error)) {
      per_frame.back()["discretisation_error_mm"] = 1e3 * frame.discretisation_error;
      error = std::max(error, frame.discretisation_error);
    }
  }
  const double mean_seconds = seconds / static_cast<double>(std::max<std::size_t>(status.size(), 1));
  text +=
      format("{} frames, {} unconverged, {} inverted tets, largest residual kept {:.2e}, {:.2f} s of solving a frame\n",
             status.size(), unconverged, inverted, residual, mean_seconds);
  if (depth > 0) {
    text += format("skin in skin: {:.2f} mm at the deepest (frame {}), more than {:g} mm in {} frames\n", 1e3 * depth,
                   deepest_frame, 1e3 * kDeep, deep);
  }
  if (volume != 0) text += format("volume of the muscle that changes most: {:+.2f} %\n", 1e2 * volume);
  if (error > 0) text += format("finer tets would move the skin by about {:.1f} mm (RMS, estimated)\n", 1e3 * error);
  return {{"frames", status.size()},
          {"unconverged", unconverged},
          {"inverted_tets", inverted},
          {"largest_residual", residual},
          {"seconds_per_frame", mean_seconds},
          {"contact_depth_mm", 1e3 * depth},
          {"largest_volume_change", volume},
          {"discretisation_error_mm", 1e3 * error},
          {"per_frame", per_frame}};
}

// Doubts about the take's shapes.
std::vector<std::string> doubts_of(const fs::path& dataset, const std::string& name) {
  trainer::SampleSet set = trainer::read_samples(read_dataset(dataset));
  for (std::vector<trainer::Sample>* samples : {&set.train, &set.heldout}) {
    std::erase_if(*samples, [&](const trainer::Sample& sample) { return set.take_of(sample) != name; });
  }
  return trainer::shape_doubts(set);
}

void run(const SimulateArguments& arguments) {
  arguments.json.require_writable();
  std::optional<PreparedBody> prepared;
  const std::vector<FrameStatus> status = simulate_take(arguments, prepared);
  const fs::path dataset = fs::path(arguments.out) / "dataset.json";
  std::string text;
  Json result = {{"dataset", dataset.string()}, {"take", arguments.take.take_name()}};
  result.update(summary(status, text));
  const std::vector<std::string> doubts = doubts_of(dataset, arguments.take.take_name());
  result["doubts"] = doubts;
  say(doubts);
  arguments.json.emit(result, text + "wrote " + dataset.string() + "\n");
}

}  // namespace

void add_simulate(CLI::App& app) {
  const auto [verb, arguments] = add_verb<SimulateArguments>(
      app, "simulate", "Make shapes of a character for every frame of a clip, by finite elements", run);
  add_required(verb, "character", arguments.character, "CHARACTER", "Character (.glb, .gltf, .fbx)");
  arguments.take.add(verb);
  add_option(verb, "--muscles", arguments.muscles, "muscles.json (default: passive tissue only)")->type_name("FILE");
  add_option(verb, "--materials", arguments.materials,
             "Tissue, as in rigs/materials.json (default: what that file says)")
      ->type_name("FILE");
  arguments.anatomy.add(verb);
  add_required(verb, "--out", arguments.out, "DATASET_DIR",
               "Dataset folder; a take is added to the dataset.json in it");
  CLI::Option* size = add_option(verb, "--tet-size", arguments.options.tet_size,
                                 "Fill the skin itself with tets of this edge inside, metres (default: a coarser skin)")
                          ->check(above_zero);
  add_flag(verb, "--draft", arguments.options.draft, "Fast: in larger tets; stores nodes (.nodes)")->excludes(size);
  add_option(verb, "--threads", arguments.options.threads, "Frames solved at once (default: one per core)")
      ->check(CLI::NonNegativeNumber);
  add_unit(verb, arguments.unit);
  arguments.json.add(verb);
}

}  // namespace bodyopt::cli
