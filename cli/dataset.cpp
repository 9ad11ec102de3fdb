// bodyopt dataset add: shapes that come from elsewhere into a dataset.
#include <filesystem>
#include <nlohmann/json.hpp>

#include "assets/characters/character.h"
#include "cli/arguments/dataset_arguments.h"
#include "runtime/core/error.h"
#include "trainer/check/add_shapes.h"

namespace bodyopt::cli {
namespace {

namespace fs = std::filesystem;

struct AddArguments {
  std::string dataset, shapes, character, muscles;
  double unit = 0;
  bool replace = false, as_given = false;
  TakeArguments take;
  JsonOption json;
};

fs::path dataset_path(const std::string& given) {
  return fs::path(given).extension() == ".json" ? fs::path(given) : fs::path(given) / "dataset.json";
}

fs::path folder_of(const fs::path& path) { return path.parent_path().empty() ? "." : path.parent_path(); }

// The dataset that is there; with --character also one that is to begin.
Dataset dataset_of(const AddArguments& arguments, const fs::path& path) {
  const bool exists = fs::exists(path);
  if (arguments.character.empty()) {
    if (exists) return read_dataset(path);
    throw Error(ErrorKind::file, path, ": there is no such dataset; --character FILE begins one");
  }
  Dataset asked;
  asked.folder = folder_of(path);
  asked.character = relative_to(asked.folder, arguments.character);
  asked.unit = arguments.unit;
  asked.muscles = relative_to(asked.folder, arguments.muscles);
  if (exists) {  // only simulations are made with these
    const Dataset there = read_dataset(path);
    asked.materials = there.materials;
    asked.body_fat = there.body_fat;
    asked.kind = there.kind;
    asked.corrections = there.corrections;
  }
  return open_dataset(asked, path);
}

void add(const AddArguments& arguments) {
  arguments.json.require_writable();
  const fs::path path = dataset_path(arguments.dataset);
  if (!arguments.character.empty()) make_folder(folder_of(path));
  const Dataset dataset = dataset_of(arguments, path);
  const Character character = read_character(dataset.folder / dataset.character, dataset.unit);
  say(character.notes);
  std::vector<int> frames;
  arguments.take.clip.read(character.skeleton, dataset.unit, frames);
  DatasetTake given = arguments.take.take(frames, dataset.folder);
  given.as_given = arguments.as_given;
  const trainer::AddedShapes added = trainer::add_shapes(dataset, path, given, arguments.shapes, arguments.replace);
  say_heldout(added.take, given);

  const std::size_t more = frames.size() - static_cast<std::size_t>(added.replaced);
  arguments.json.emit(
      {{"dataset", path.string()},
       {"take", added.take.name},
       {"added", more},
       {"replaced", added.replaced},
       {"frames", added.take.frames.size()},
       {"shapes", added.take.shapes},
       {"fit_mm", added.check.fit_mm}},
      format("{}: {} frames added, {} replaced, {:.2f} mm RMS from the skinned character; it has {} now\n"
             "wrote {}\n",
             added.take.name, more, added.replaced, added.check.fit_mm, added.take.frames.size(), path.string()));
}

}  // namespace

void add_dataset(CLI::App& app) {
  CLI::App& verb = add_verb(app, "dataset", "Add poses and shapes to train on");
  verb.require_subcommand(1);
  const auto [subverb, arguments] =
      add_verb<AddArguments>(verb, "add", "Adds shapes that come from elsewhere: a take, or frames to a take", add);
  add_required(subverb, "dataset", arguments.dataset, "DATASET", "Dataset (folder or dataset.json)");
  arguments.take.add(subverb);
  add_required(subverb, "--shapes", arguments.shapes, "CACHE",
               "Their cache (.pc2, .mdd, or .nodes of a draft): a sample per frame of --frames, vertices as in the "
               "character's file; it is copied");
  add_flag(subverb, "--replace", arguments.replace, "Put the shapes in the place of those that the take has already");
  add_flag(subverb, "--as-given", arguments.as_given,
           "The shapes lie where they are meant to, though they seem late, moved, turned or of another size");
  CLI::Option* character = add_option(subverb, "--character", arguments.character,
                                      "Character (.glb, .gltf, .fbx) of the dataset; begins it where there is none")
                               ->type_name("CHARACTER");
  add_option(subverb, "--muscles", arguments.muscles, "muscles.json that goes with --character")
      ->needs(character)
      ->type_name("FILE");
  add_unit(subverb, arguments.unit);
  subverb.get_option("--unit")->needs(character);
  arguments.json.add(subverb);
}

}  // namespace bodyopt::cli
