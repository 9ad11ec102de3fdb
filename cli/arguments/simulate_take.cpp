#include "cli/arguments/simulate_take.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <filesystem>

#include "assets/frame_range.h"
#include "runtime/core/error.h"

namespace bodyopt::cli {
namespace {

namespace fs = std::filesystem;

// What the arguments say of a dataset in that folder.
Dataset asked_dataset(const SimulationArguments& arguments, double unit, const fs::path& folder) {
  Dataset dataset;
  dataset.folder = folder;
  dataset.character = relative_to(folder, arguments.character);
  dataset.unit = unit;
  dataset.muscles = relative_to(folder, arguments.muscles);
  dataset.materials = relative_to(folder, arguments.materials);
  arguments.anatomy.put_into(dataset);
  return dataset;
}

DatasetTake new_take(const SimulationArguments& arguments, const std::vector<int>& frames, const fs::path& folder) {
  DatasetTake take = arguments.take.take(frames, folder);
  take.shapes = take.name + (arguments.options.draft ? ".nodes" : ".pc2");
  take.shapes_status = take.name + ".status.json";
  return take;
}

// A take that is there already keeps its frames and gets the new ones; finished shapes are not solved again.
void add_frames(const Dataset& dataset, const DatasetTake& there, DatasetTake& take) {
  if (there.shapes != take.shapes && fs::path(there.shapes).stem() == fs::path(take.shapes).stem()) {
    const bool draft = fs::path(there.shapes).extension() == ".nodes";
    throw Error(ErrorKind::mismatch, format("the take '{}' is {}: {} --draft to add frames to it", there.name,
                                            draft ? "a draft" : "no draft", draft ? "give" : "leave out"));
  }
  require_same_motion(there, take);
  if (there.shapes != take.shapes || has_given_shapes(dataset, there)) {
    throw Error(ErrorKind::mismatch,
                format("the take '{}' has shapes that do not come from simulate ({}), which would replace them; give "
                       "the new one a --name",
                       there.name, there.shapes));
  }
  const auto known = std::ranges::count_if(
      take.frames, [&](int frame) { return std::ranges::find(there.frames, frame) != there.frames.end(); });
  if (known > 0) spdlog::info("{} of {} frames are in the take '{}' already", known, take.frames.size(), there.name);
  const DatasetTake asked = take;
  take.frames = unite_frames(take.frames, there.frames);
  take.heldout = unite_frames(take.heldout, there.heldout);
  say_heldout(take, asked);
}

// A dataset that is there knows the unit of its character, which the arguments may lack.
double unit_of(const SimulationArguments& arguments, const fs::path& dataset_path) {
  return arguments.unit == 0 && fs::exists(dataset_path) ? read_dataset(dataset_path).unit : arguments.unit;
}

}  // namespace

std::vector<FrameStatus> simulate_take(const SimulationArguments& arguments) {
  const fs::path folder = arguments.out;
  const fs::path dataset_path = folder / "dataset.json";
  const double unit = unit_of(arguments, dataset_path);
  const Character character = read_character(arguments.character, unit);
  say(character.notes);
  std::vector<Muscle> muscles;
  if (!arguments.muscles.empty()) muscles = read_muscles(arguments.muscles, character.skeleton);
  SimulateOptions options = arguments.options;
  options.warn = [](const std::string& warning) { say({warning}); };
  options.inform = [](const std::string& text) { spdlog::info(text); };
  options.anatomy = arguments.anatomy.options(character.skeleton);
  if (!arguments.materials.empty()) options.materials = read_materials(arguments.materials);
  std::vector<int> frames;
  const Clip clip = arguments.take.clip.read(character.skeleton, unit, frames);

  make_folder(folder);
  DatasetTake take = new_take(arguments, frames, folder);
  const TakeLock lock(folder / take.shapes);  // until dataset.json names the frames that the shapes are of
  const Dataset asked = asked_dataset(arguments, unit, folder);
  const Dataset dataset = open_dataset(asked, dataset_path);
  for (const DatasetTake& there : dataset.takes) {
    if (there.name == take.name) add_frames(dataset, there, take);
  }
  require_place_for(asked, take, dataset_path);
  spdlog::info("preparing the body: tetrahedra, bones, muscles");
  std::vector<FrameStatus> status =
      simulate(character, muscles, clip, take.frames, lock, folder / take.shapes_status, options);
  put_take(asked, take, dataset_path);
  return status;
}

}  // namespace bodyopt::cli
