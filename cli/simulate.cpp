// bodyopt simulate: a character and a clip to shapes by finite elements.
#include "trainer/simulate/simulate.h"

#include <algorithm>
#include <filesystem>

#include "cli/common.h"
#include "runtime/basis/error.h"
#include "trainer/dataset/frame_range.h"

namespace bodyopt::cli {
namespace {

namespace fs = std::filesystem;

struct SimulateArguments {
  std::string character, muscles, out, name, heldout;
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
  const std::string character = fs::proximate(arguments.character, folder).string();
  const std::string muscles = arguments.muscles.empty() ? "" : fs::proximate(arguments.muscles, folder).string();
  if (!fs::exists(folder / "dataset.json")) {
    Dataset dataset;
    dataset.folder = folder;
    dataset.character = character;
    dataset.unit = arguments.unit;
    dataset.muscles = muscles;
    return dataset;
  }
  Dataset dataset = read_dataset(folder / "dataset.json");
  if (dataset.character != character || dataset.muscles != muscles || dataset.unit != arguments.unit) {
    throw Error(ErrorKind::mismatch,
                format("%s holds shapes of '%s' with muscles '%s'; asked for '%s' with muscles '%s': use another --out",
                       (folder / "dataset.json").c_str(), dataset.character.c_str(), dataset.muscles.c_str(),
                       character.c_str(), muscles.c_str()));
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

void run(const SimulateArguments& arguments) {
  const Character character = read_character(arguments.character, arguments.unit);
  say(character.notes);
  std::vector<Muscle> muscles;
  if (!arguments.muscles.empty()) muscles = read_muscles(arguments.muscles, character.skeleton);
  std::vector<int> frames;
  const Clip clip = arguments.clip.read(character.skeleton, arguments.unit, frames);

  const fs::path folder = arguments.out;
  make_folder(folder);
  Dataset dataset = open_dataset(arguments, folder);
  DatasetTake take;
  take.name = arguments.name.empty() ? take_name(arguments.clip.source) : arguments.name;
  take.clip = relative_source(arguments.clip.source, folder);
  take.fps = arguments.clip.options.fps;
  take.first_frame = arguments.clip.options.first_frame;
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

  const std::vector<FrameStatus> status =
      simulate(character, muscles, clip, frames, folder / take.shapes, folder / take.shapes_status, arguments.options);
  std::erase_if(dataset.takes, [&](const DatasetTake& other) { return other.name == take.name; });
  dataset.takes.push_back(take);
  write_dataset(dataset, folder / "dataset.json");

  int unconverged = 0;
  double worst = 0, seconds = 0;
  Json per_frame = Json::array();
  for (const FrameStatus& frame : status) {
    unconverged += frame.converged ? 0 : 1;
    if (frame.converged) worst = std::max(worst, frame.residual);
    seconds += frame.seconds;
    per_frame.push_back({{"frame", frame.frame},
                         {"residual", frame.residual},
                         {"converged", frame.converged},
                         {"iterations", frame.iterations},
                         {"inverted_tets", frame.inverted_tets}});
  }
  std::string text = "frame  residual   iterations\n";
  for (const FrameStatus& frame : status) {
    text += format("%5d  %.2e  %6d%s\n", frame.frame, frame.residual, frame.iterations,
                   frame.converged ? "" : "  unconverged: train will leave it out");
  }
  text += format("%zu frames, %d unconverged, largest residual kept %.2e, %.2f s of solving a frame\n", status.size(),
                 unconverged, worst, status.empty() ? 0.0 : seconds / static_cast<double>(status.size()));
  text += "wrote " + (folder / "dataset.json").string() + "\n";
  arguments.json.emit({{"dataset", (folder / "dataset.json").string()},
                       {"take", take.name},
                       {"frames", status.size()},
                       {"unconverged", unconverged},
                       {"largest_residual", worst},
                       {"per_frame", per_frame}},
                      text);
}

}  // namespace

void add_simulate(CLI::App& app) {
  auto arguments = std::make_shared<SimulateArguments>();
  CLI::App& verb =
      *app.add_subcommand("simulate", "Shapes of a character for every frame of a clip, by finite elements");
  verb.add_option("character", arguments->character, "Character (.glb, .gltf)")->required()->type_name("CHARACTER");
  arguments->clip.add(verb);
  verb.add_option("--muscles", arguments->muscles, "muscles.json (default: passive tissue only)")->type_name("FILE");
  verb.add_option("--out", arguments->out, "Dataset folder; a take is added to the dataset.json in it")
      ->required()
      ->type_name("DATASET_DIR");
  verb.add_option("--name", arguments->name, "Name of the take (default: the clip's)");
  verb.add_option("--heldout", arguments->heldout, "Frames never to train on, as a range, or 'all'")->type_name("R");
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
