// bodyopt simulate: a character and a clip to shapes by finite elements.
#include "trainer/simulate/simulate.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "cli/dataset_arguments.h"
#include "runtime/basis/error.h"
#include "trainer/dataset/frame_range.h"

namespace bodyopt::cli {
namespace {

namespace fs = std::filesystem;

struct SimulateArguments {
  std::string character, muscles, materials, out;
  double unit = 0;
  TakeArguments take;
  SimulateOptions options;
  JsonOption json;
};

// What the arguments say of a dataset in that folder.
Dataset asked_dataset(const SimulateArguments& arguments, const fs::path& folder) {
  Dataset dataset;
  dataset.folder = folder;
  dataset.character = relative_to(folder, arguments.character);
  dataset.unit = arguments.unit;
  dataset.muscles = relative_to(folder, arguments.muscles);
  dataset.materials = relative_to(folder, arguments.materials);
  return dataset;
}

DatasetTake new_take(const SimulateArguments& arguments, const std::vector<int>& frames, const fs::path& folder) {
  DatasetTake take = arguments.take.take(frames, folder);
  take.shapes = take.name + (arguments.options.draft ? ".nodes" : ".pc2");
  take.shapes_status = take.name + ".status.json";
  return take;
}

// A take that is there already keeps its frames and gets the new ones; finished shapes are not solved again.
void add_frames(const Dataset& dataset, const DatasetTake& there, DatasetTake& take) {
  if (there.shapes != take.shapes && fs::path(there.shapes).stem() == fs::path(take.shapes).stem()) {
    const bool draft = fs::path(there.shapes).extension() == ".nodes";
    throw Error(ErrorKind::mismatch, format("the take '%s' is %s: %s --draft to add frames to it", there.name.c_str(),
                                            draft ? "a draft" : "no draft", draft ? "give" : "leave out"));
  }
  require_same_motion(there, take);
  if (there.shapes != take.shapes || has_given_shapes(dataset, there)) {
    throw Error(ErrorKind::mismatch,
                format("the take '%s' has shapes that do not come from simulate (%s), which would replace them; give "
                       "the new one a --name",
                       there.name.c_str(), there.shapes.c_str()));
  }
  const auto known = std::count_if(take.frames.begin(), take.frames.end(), [&](int frame) {
    return std::find(there.frames.begin(), there.frames.end(), frame) != there.frames.end();
  });
  if (known > 0) spdlog::info("{} of {} frames are in the take '{}' already", known, take.frames.size(), there.name);
  const DatasetTake asked = take;
  take.frames = unite_frames(take.frames, there.frames);
  take.heldout = unite_frames(take.heldout, there.heldout);
  say_heldout(take, asked);
}

// Metres of skin in skin that are worth a look.
constexpr double kDeep = 5e-3;

// What a TD has to know of a run; `text` names the frames that need a look.
Json summary(const std::vector<FrameStatus>& status, std::string& text) {
  int unconverged = 0, inverted = 0, deep = 0;
  double residual = 0, seconds = 0, depth = 0, volume = 0;
  int deepest_frame = 0;
  Json per_frame = Json::array();
  for (const FrameStatus& frame : status) {
    if (frame.converged) {
      residual = std::max(residual, frame.residual);
    } else {
      ++unconverged;
      text += format("frame %d did not converge (residual %.2e, %d inverted tets): train will leave it out\n",
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
  }
  const double mean_seconds = seconds / static_cast<double>(std::max<std::size_t>(status.size(), 1));
  text +=
      format("%zu frames, %d unconverged, %d inverted tets, largest residual kept %.2e, %.2f s of solving a frame\n",
             status.size(), unconverged, inverted, residual, mean_seconds);
  if (depth > 0) {
    text += format("skin in skin: %.2f mm at the deepest (frame %d), more than %g mm in %d frames\n", 1e3 * depth,
                   deepest_frame, 1e3 * kDeep, deep);
  }
  text += format("volume of the muscle that changes most: %+.2f %%\n", 1e2 * volume);
  return {{"frames", status.size()},           {"unconverged", unconverged},
          {"inverted_tets", inverted},         {"largest_residual", residual},
          {"seconds_per_frame", mean_seconds}, {"contact_depth_mm", 1e3 * depth},
          {"largest_volume_change", volume},   {"per_frame", per_frame}};
}

void run(const SimulateArguments& arguments) {
  const Character character = read_character(arguments.character, arguments.unit);
  say(character.notes);
  std::vector<Muscle> muscles;
  if (!arguments.muscles.empty()) muscles = read_muscles(arguments.muscles, character.skeleton);
  SimulateOptions options = arguments.options;
  if (!arguments.materials.empty()) options.materials = read_materials(arguments.materials);
  std::vector<int> frames;
  const Clip clip = arguments.take.clip.read(character.skeleton, arguments.unit, frames);

  const fs::path folder = arguments.out;
  make_folder(folder);
  const fs::path dataset_path = folder / "dataset.json";
  DatasetTake take = new_take(arguments, frames, folder);
  const TakeLock lock(folder / take.shapes);  // until dataset.json names the frames that the shapes are of
  const Dataset asked = asked_dataset(arguments, folder);
  Dataset dataset = open_dataset(asked, dataset_path);
  for (const DatasetTake& there : dataset.takes) {
    if (there.name == take.name) add_frames(dataset, there, take);
  }
  require_writable(dataset_path);
  arguments.json.require_writable();
  spdlog::info("preparing the body: tetrahedra, bones, muscles");
  const std::vector<FrameStatus> status =
      simulate(character, muscles, clip, take.frames, lock, folder / take.shapes_status, options);
  dataset = open_dataset(asked, dataset_path);  // another run may have added a take meanwhile
  std::erase_if(dataset.takes, [&](const DatasetTake& other) { return other.name == take.name; });
  dataset.takes.push_back(take);
  write_dataset(dataset, dataset_path);

  std::string text;
  Json result = {{"dataset", dataset_path.string()}, {"take", take.name}};
  result.update(summary(status, text));
  arguments.json.emit(result, text + "wrote " + dataset_path.string() + "\n");
}

}  // namespace

void add_simulate(CLI::App& app) {
  auto arguments = std::make_shared<SimulateArguments>();
  CLI::App& verb =
      *app.add_subcommand("simulate", "Shapes of a character for every frame of a clip, by finite elements");
  verb.add_option("character", arguments->character, "Character (.glb, .gltf)")->required()->type_name("CHARACTER");
  arguments->take.add(verb);
  verb.add_option("--muscles", arguments->muscles, "muscles.json (default: passive tissue only)")->type_name("FILE");
  verb.add_option("--materials", arguments->materials,
                  "Tissue, as in rigs/materials.json (default: what that file says)")
      ->type_name("FILE");
  verb.add_option("--out", arguments->out, "Dataset folder; a take is added to the dataset.json in it")
      ->required()
      ->type_name("DATASET_DIR");
  CLI::Option* size = verb.add_option("--tet-size", arguments->options.tet_size,
                                      "Largest tet edge inside, metres (default: from the skin)")
                          ->check(CLI::PositiveNumber);
  verb.add_flag("--draft", arguments->options.draft, "Fast: in a cage of 1,500 nodes or fewer; stores nodes (.nodes)")
      ->excludes(size);
  verb.add_option("--threads", arguments->options.threads, "Frames solved at once (default: one per core)")
      ->check(CLI::NonNegativeNumber);
  add_unit(verb, arguments->unit);
  arguments->json.add(verb);
  arguments->options.warn = [](const std::string& warning) { say({warning}); };
  verb.callback([arguments] { run(*arguments); });
}

}  // namespace bodyopt::cli
