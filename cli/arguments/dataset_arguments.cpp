#include "cli/arguments/dataset_arguments.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cctype>
#include <filesystem>

#include "assets/clips/clip_source.h"
#include "base/frame_range.h"
#include "runtime/core/error.h"
#include "trainer/simulate/simulate.h"

namespace bodyopt::cli {
namespace {

namespace fs = std::filesystem;

// A clip's source with its file made relative to a folder.
std::string relative_source(const fs::path& folder, const std::string& source) {
  const ClipSource split = split_source(source);
  return relative_to(folder, split.path.string()) + (split.name.empty() ? "" : '#' + split.name);
}

std::string called(const std::string& source) {
  const ClipSource split = split_source(source);
  std::string name = split.name.empty() ? split.path.stem().string() : split.name;
  for (char& c : name) {
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '-' && c != '_') c = '_';
  }
  return name;
}

// Files are called by a take's name, in the dataset's folder and nowhere else.
std::string refuse_as_name(const std::string& name) {
  const auto fits = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) || c == '-' || c == '_' || c == '.';
  };
  if (!name.empty() && name.front() != '.' && std::ranges::all_of(name, fits)) return "";
  return "expected a name of letters, digits, '-', '_' and '.', and no '.' first, found '" + name + "'";
}

bool has(const std::vector<int>& frames, int frame) { return std::ranges::find(frames, frame) != frames.end(); }

std::string refuse_as_kind(const std::string& name) {
  return trainer::body_kind_of(name) ? "" : "expected one of " + trainer::body_kind_names() + ", found '" + name + "'";
}

// The dataset in that folder as the arguments describe it.
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

std::string TakeArguments::take_name() const { return name.empty() ? called(clip.source) : name; }

void TakeArguments::add(CLI::App& verb) {
  clip.add(verb);
  add_option(verb, "--name", name, "Name of the take (default: the clip's)")->check(refuse_as_name);
  add_option(verb, "--heldout", heldout, "R", "Frames never to train on, as a range, or 'all'");
}

DatasetTake TakeArguments::take(const std::vector<int>& frames, const fs::path& folder) const {
  DatasetTake take;
  take.name = take_name();
  take.clip = relative_source(folder, clip.source);
  take.fps = clip.options.fps;
  take.first_frame = clip.options.first_frame;
  take.controls = relative_to(folder, clip.options.controls);
  take.joint_map = relative_to(folder, clip.options.joint_map);
  take.up = clip.options.up;
  take.frames = frames;
  if (heldout == "all") {
    take.heldout = frames;
  } else if (!heldout.empty()) {
    take.heldout = parse_frame_range(heldout);
    for (const int frame : take.heldout) {
      if (has(frames, frame)) continue;
      throw Error(ErrorKind::usage,
                  format("--heldout names frame {}, which is not among the frames of --frames", frame));
    }
  }
  return take;
}

std::string relative_to(const fs::path& folder, const std::string& path) {
  return path.empty() ? path : fs::proximate(path, folder).string();
}

void say_heldout(const DatasetTake& take, const DatasetTake& asked) {
  const auto kept = std::ranges::count_if(
      asked.frames, [&](int frame) { return has(take.heldout, frame) && !has(asked.heldout, frame); });
  if (kept == 0) return;
  spdlog::warn("{} of {} frames are held out: train will not learn from them", kept, asked.frames.size());
}

void FieldArguments::add(CLI::App& verb) {
  add_option(verb, "--body-fat", body_fat, "Fat, as a share of the body's mass, 0.02 to 0.6 (default: 0.15)")
      ->check(number_from(0.02, 0.6));
  add_option(verb, "--kind", kind, "KIND", "Kind of body: " + trainer::body_kind_names() + " (default: recognised)")
      ->check(refuse_as_kind);
  add_option(verb, "--corrections", corrections, "FILE",
             "What an artist corrects of bones, fat and muscles (anatomy.json); --kind and --body-fat go before it");
}

trainer::AnatomyOptions FieldArguments::options(const Skeleton& skeleton) const {
  Dataset given;
  given.body_fat = body_fat;
  given.kind = kind;
  given.corrections = corrections;
  return trainer::anatomy_options(given, skeleton);
}

void FieldArguments::put_into(Dataset& dataset) const {
  dataset.body_fat = body_fat;
  dataset.kind = kind;
  dataset.corrections = relative_to(dataset.folder, corrections);
}

PreparedBody::PreparedBody(Character of, std::vector<Muscle> its_muscles, const trainer::SimulateOptions& options)
    : character(std::move(of)),
      muscles(std::move(its_muscles)),
      body(trainer::make_compared_body(character, muscles, options)) {}

std::vector<FrameStatus> simulate_take(const SimulationArguments& arguments, std::optional<PreparedBody>& prepared) {
  const fs::path folder = arguments.out;
  const fs::path dataset_path = folder / "dataset.json";
  const double unit = unit_of(arguments, dataset_path);
  const Character character = prepared ? prepared->character : read_character(arguments.character, unit);
  if (!prepared) say(character.notes);
  trainer::SimulateOptions options = arguments.options;
  options.warn = [](const std::string& warning) { say({warning}); };
  options.inform = [](const std::string& text) { spdlog::info(text); };
  options.anatomy = arguments.anatomy.options(character.skeleton);
  if (!arguments.materials.empty()) options.materials = trainer::read_materials(arguments.materials);
  std::vector<int> frames;
  const Clip clip = arguments.take.clip.read(character.skeleton, unit, frames);

  make_folder(folder);
  DatasetTake take = new_take(arguments, frames, folder);
  // Until dataset.json names the frames that the shapes are of.
  const TakeLock lock(folder / take.shapes, arguments.instead);
  const Dataset asked = asked_dataset(arguments, unit, folder);
  const Dataset dataset = open_dataset(asked, dataset_path);
  for (const DatasetTake& there : dataset.takes) {
    if (there.name == take.name) add_frames(dataset, there, take);
  }
  require_place_for(asked, take, dataset_path);
  if (!prepared) {
    std::vector<Muscle> muscles;
    if (!arguments.muscles.empty()) muscles = read_muscles(arguments.muscles, character.skeleton);
    spdlog::info("preparing the body: tetrahedra, bones, muscles");
    prepared.emplace(character, std::move(muscles), options);
  }
  std::vector<FrameStatus> status = trainer::simulate(prepared->body, character, prepared->muscles, clip, take.frames,
                                                      lock, folder / take.shapes_status, options);
  put_take(asked, take, dataset_path);
  return status;
}

}  // namespace bodyopt::cli
