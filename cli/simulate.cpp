// bodyopt simulate: a character and a clip to shapes by finite elements.
#include "trainer/simulate/simulate.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "cli/common.h"
#include "runtime/basis/error.h"
#include "trainer/dataset/frame_range.h"

namespace bodyopt::cli {
namespace {

namespace fs = std::filesystem;

struct SimulateArguments {
  std::string character, muscles, materials, out, name, heldout;
  double unit = 0;
  ClipArguments clip;
  SimulateOptions options;
  JsonOption json;
};

// The part of a clip source before '#' made relative to a folder.
std::string relative_source(const std::string& source, const fs::path& folder) {
  const std::size_t hash = source.find('#');
  const std::string name = hash == std::string::npos ? "" : source.substr(hash);
  return fs::proximate(source.substr(0, hash), folder).string() + name;
}

// The dataset in the folder, or a new one. One folder holds the takes of one character.
Dataset open_dataset(const SimulateArguments& arguments, const fs::path& folder) {
  const auto relative = [&](const std::string& path) {
    return path.empty() ? path : fs::proximate(path, folder).string();
  };
  const std::string character = relative(arguments.character), muscles = relative(arguments.muscles),
                    materials = relative(arguments.materials);
  if (!fs::exists(folder / "dataset.json")) {
    Dataset dataset;
    dataset.folder = folder;
    dataset.character = character;
    dataset.unit = arguments.unit;
    dataset.muscles = muscles;
    dataset.materials = materials;
    return dataset;
  }
  Dataset dataset = read_dataset(folder / "dataset.json");
  const auto described = [](const std::string& of, double unit, const std::string& with, const std::string& made_of) {
    return format("'%s' (unit %g m) with muscles '%s' and materials '%s'", of.c_str(), unit > 0 ? unit : 1.0,
                  with.c_str(), made_of.c_str());
  };
  const std::string there = described(dataset.character, dataset.unit, dataset.muscles, dataset.materials),
                    asked = described(character, arguments.unit, muscles, materials);
  if (there != asked) {
    throw Error(ErrorKind::mismatch, format("%s holds shapes of %s; asked for %s: use another --out",
                                            (folder / "dataset.json").c_str(), there.c_str(), asked.c_str()));
  }
  return dataset;
}

std::string take_name(const std::string& source) {
  const std::size_t hash = source.find('#');
  std::string name = hash == std::string::npos ? fs::path(source).stem().string() : source.substr(hash + 1);
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
  if (!name.empty() && name.front() != '.' && std::all_of(name.begin(), name.end(), fits)) return "";
  return "expected a name of letters, digits, '-', '_' and '.', and no '.' first, found '" + name + "'";
}

DatasetTake new_take(const SimulateArguments& arguments, const std::vector<int>& frames, const fs::path& folder) {
  DatasetTake take;
  take.name = arguments.name.empty() ? take_name(arguments.clip.source) : arguments.name;
  take.clip = relative_source(arguments.clip.source, folder);
  take.fps = arguments.clip.options.fps;
  take.first_frame = arguments.clip.options.first_frame;
  if (!arguments.clip.options.controls.empty()) {
    take.controls = fs::proximate(arguments.clip.options.controls, folder).string();
  }
  take.frames = frames;
  take.shapes = take.name + (arguments.options.draft ? ".nodes" : ".pc2");
  take.shapes_status = take.name + ".status.json";
  if (arguments.heldout == "all") {
    take.heldout = frames;
  } else if (!arguments.heldout.empty()) {
    take.heldout = parse_frame_range(arguments.heldout);
    for (const int frame : take.heldout) {
      if (std::find(frames.begin(), frames.end(), frame) == frames.end()) {
        throw Error(ErrorKind::usage, format("--heldout names frame %d, which is not simulated", frame));
      }
    }
  }
  return take;
}

// A take that is there already keeps its frames and gets the new ones; finished shapes are not solved again.
void add_frames(const DatasetTake& there, DatasetTake& take) {
  if (there.shapes != take.shapes && fs::path(there.shapes).stem() == fs::path(take.shapes).stem()) {
    const bool draft = fs::path(there.shapes).extension() == ".nodes";
    throw Error(ErrorKind::mismatch, format("the take '%s' is %s: %s --draft to add frames to it", there.name.c_str(),
                                            draft ? "a draft" : "no draft", draft ? "give" : "leave out"));
  }
  if (there.clip != take.clip || there.fps != take.fps || there.first_frame != take.first_frame ||
      there.controls != take.controls || there.shapes != take.shapes) {
    throw Error(ErrorKind::mismatch,
                format("the dataset has a take '%s' already: %s of '%s' at %g frames a second from frame %d, controls "
                       "'%s'; give the new one a --name",
                       there.name.c_str(), there.shapes.c_str(), there.clip.c_str(), there.fps, there.first_frame,
                       there.controls.c_str()));
  }
  const auto unite = [](std::vector<int>& frames, const std::vector<int>& more) {
    frames.insert(frames.end(), more.begin(), more.end());
    std::sort(frames.begin(), frames.end());
    frames.erase(std::unique(frames.begin(), frames.end()), frames.end());
  };
  const auto among = [&](const std::vector<int>& frames) {
    return std::count_if(take.frames.begin(), take.frames.end(),
                         [&](int frame) { return std::find(frames.begin(), frames.end(), frame) != frames.end(); });
  };
  if (const auto known = among(there.frames); known > 0) {
    spdlog::info("{} of {} frames are in the take '{}' already", known, take.frames.size(), there.name);
  }
  if (const auto kept = among(there.heldout); kept > 0) {
    spdlog::warn("{} of {} frames are held out: train will not learn from them", kept, take.frames.size());
  }
  unite(take.frames, there.frames);
  unite(take.heldout, there.heldout);
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
  const Clip clip = arguments.clip.read(character.skeleton, arguments.unit, frames);

  const fs::path folder = arguments.out;
  make_folder(folder);
  const fs::path dataset_path = folder / "dataset.json";
  DatasetTake take = new_take(arguments, frames, folder);
  const TakeLock lock(folder / take.shapes);  // until dataset.json names the frames that the shapes are of
  Dataset dataset = open_dataset(arguments, folder);
  for (const DatasetTake& there : dataset.takes) {
    if (there.name == take.name) add_frames(there, take);
  }
  require_writable(dataset_path);
  arguments.json.require_writable();
  spdlog::info("preparing the body: tetrahedra, bones, muscles");
  const std::vector<FrameStatus> status =
      simulate(character, muscles, clip, take.frames, lock, folder / take.shapes_status, options);
  dataset = open_dataset(arguments, folder);  // another run may have added a take meanwhile
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
  arguments->clip.add(verb);
  verb.add_option("--muscles", arguments->muscles, "muscles.json (default: passive tissue only)")->type_name("FILE");
  verb.add_option("--materials", arguments->materials,
                  "Tissue, as in rigs/materials.json (default: what that file says)")
      ->type_name("FILE");
  verb.add_option("--out", arguments->out, "Dataset folder; a take is added to the dataset.json in it")
      ->required()
      ->type_name("DATASET_DIR");
  verb.add_option("--name", arguments->name, "Name of the take (default: the clip's)")->check(refuse_as_name);
  verb.add_option("--heldout", arguments->heldout, "Frames never to train on, as a range, or 'all'")
      ->type_name("R")
      ->check(refuse_empty);
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
