// bodyopt curate: the stack of modifiers that a dataset's shapes are read through.
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>

#include "base/wording.h"
#include "cli/curate/curate_arguments.h"
#include "cli/curate/stack_report.h"
#include "dataset/modifier.h"
#include "trainer/curate/edit_stack.h"
#include "trainer/curate/modifier_types.h"
#include "trainer/curate/offset_cache.h"
#include "trainer/train/judge/test_errors.h"

namespace bodyopt::cli {
namespace {

void bake(const CurateArguments& arguments) {
  make_folder(arguments.out);
  Dataset dataset = read_dataset(path_of(arguments));
  if (arguments.heldout_every > 0) trainer::hold_out_blocks(dataset, arguments.heldout_every);
  const trainer::ShapeStack stack(trainer::read_pose_database(dataset));
  say(stack.notes());
  const Dataset baked = trainer::bake_dataset(stack, arguments.out);
  std::size_t frames = 0;
  for (const DatasetTake& take : baked.takes) frames += take.frames.size();
  arguments.json.emit({{"dataset", arguments.out}, {"takes", baked.takes.size()}, {"frames", frames}},
                      format("wrote {}: {} frames of {} takes, whose shapes are what the modifiers made of them\n",
                             arguments.out, frames, baked.takes.size()));
}

void prune(const CurateArguments& arguments) {
  const trainer::PrunedFiles gone = trainer::prune_modifiers(path_of(arguments), arguments.history);
  arguments.json.emit({{"files", gone.files}, {"bytes", gone.bytes}},
                      format("removed {}, {:.1f} MiB\n", count_of(gone.files, "file", "files"),
                             static_cast<double>(gone.bytes) / (1 << 20)));
}

DeclaredVerb<CurateArguments> subverb(CLI::App& parent, const char* name, const char* description,
                                      const std::function<void(const CurateArguments&)>& run) {
  const auto arguments = std::make_shared<CurateArguments>();
  CLI::App& verb = add_verb(parent, name, description);
  verb.callback([=] { run(*arguments); });
  add_required(verb, "dataset", arguments->dataset, "DATASET", "Dataset (folder or dataset.json)");
  arguments->json.add(verb);
  return {verb, *arguments};
}

void add_name(CLI::App& sub, CurateArguments& arguments) {
  add_required(sub, "name", arguments.name, "NAME", "Name of the modifier");
}

void add_frame(CLI::App& sub, CurateArguments& arguments) {
  add_option(sub, "--take", arguments.take, "Take")->required();
  add_option(sub, "--frame", arguments.frame, "Its frame")->required();
  add_flag(sub, "--unposed", arguments.unposed, "As the rest skin with the frame's displacements, not posed");
}

void add_scope(CLI::App& sub, CurateArguments& arguments) {
  add_option(sub, "--strength", arguments.strength, "0 (nothing) to 1 (all)")->check(number_from(0, 1));
  add_option(sub, "--take", arguments.take, "Only frames of this take");
  add_option(sub, "--frames", arguments.frames, "Only these frames, e.g. 1001-1100x2");
  CLI::Option* near = add_option(sub, "--near", arguments.near, "Only poses near this frame of --take");
  add_option(sub, "--within", arguments.within, "Degrees that these are away at most")
      ->needs(near)
      ->check(number_from(0, 1e4));
  near->needs(sub.get_option("--within"));
  add_option(sub, "--near-joints", arguments.near_joints, "Joints that count for that (default: all)")->needs(near);
  add_option(sub, "--list", arguments.list, "Only the selection of this name in dataset.json");
  add_option(sub, "--joints", arguments.joints, "Only the skin of these joints");
  add_option(sub, "--muscles", arguments.muscles, "Only the skin over these muscles");
  add_option(sub, "--regions", arguments.regions, "Only these painted regions");
  add_option(sub, "--set", arguments.settings, "A parameter of the type, KEY=VALUE; null takes it away")
      ->type_name("KEY=VALUE");
}

void add_edits(CLI::App& verb) {
  const auto [adding, added] = subverb(verb, "add", "Puts a modifier on top of the stack", add_to_stack);
  std::vector<std::string> types;
  std::string described;
  for (const trainer::ModifierType& type : trainer::modifier_types()) {
    types.push_back(type.name);
    described += std::string("\n  ") + type.name + ": " + type.what;
  }
  add_option(adding, "type", added.type, "Its type")->required()->check(CLI::IsMember(types));
  add_option(adding, "--name", added.name, "Its name (default: the type's)");
  add_scope(adding, added);
  adding.footer("Types:" + described);

  const auto [changing, changed] =
      subverb(verb, "edit", "Changes a modifier; what is not named stays", [&verb](const CurateArguments& arguments) {
        edit_stack(arguments, verb.get_subcommand("edit")->get_option("--strength")->count() > 0);
      });
  add_name(changing, changed);
  add_option(changing, "--name", changed.new_name, "Its new name");
  add_scope(changing, changed);
  add_flag(changing, "--all-frames", changed.everywhere, "All frames again");
  add_flag(changing, "--whole-skin", changed.whole_skin, "The whole skin again");

  const auto [moving, moved] =
      subverb(verb, "move", "Moves a modifier to another place of the stack", [](const CurateArguments& arguments) {
        trainer::move_modifier(path_of(arguments), arguments.name, arguments.place);
        emit_stack(arguments);
      });
  add_name(moving, moved);
  add_required(moving, "place", moved.place, "PLACE", "Its place, from 1 (nearest to the raw shapes)");
  for (const bool enabled : {true, false}) {
    const auto [switching, switched] =
        subverb(verb, enabled ? "enable" : "disable", enabled ? "Switches a modifier on" : "Switches it off",
                [enabled](const CurateArguments& arguments) {
                  trainer::enable_modifier(path_of(arguments), arguments.name, enabled);
                  emit_stack(arguments);
                });
    add_name(switching, switched);
  }
  const auto [removing, removed] = subverb(verb, "remove", "Takes a modifier off the stack; undo brings it back",
                                           [](const CurateArguments& arguments) {
                                             trainer::remove_modifier(path_of(arguments), arguments.name);
                                             emit_stack(arguments);
                                           });
  add_name(removing, removed);
  for (const bool back : {true, false}) {
    subverb(verb, back ? "undo" : "redo", back ? "Takes the last edit back" : "Does what was undone again",
            [back](const CurateArguments& arguments) {
              back ? undo_modifiers(path_of(arguments)) : redo_modifiers(path_of(arguments));
              emit_stack(arguments);
            });
  }
}

}  // namespace

void add_curate(CLI::App& app) {
  CLI::App& verb =
      add_verb(app, "curate", "Edit the modifiers that a dataset's shapes are read through, all of them undoable");
  verb.require_subcommand(1);
  subverb(verb, "list", "The stack, from the raw shapes upwards",
          [](const CurateArguments& arguments) { emit_stack(arguments); });
  add_edits(verb);

  const auto [pruning, pruned] = subverb(
      verb, "prune", "Removes caches, and files that neither the stack, its history nor exported frames name", prune);
  add_flag(
      pruning, "--history", pruned.history,
      "The history and what was exported, too: no edit before this can be undone, and a mesh is of its frame as it is");

  const auto [measuring, measured] =
      subverb(verb, "diff", "What every modifier does to the shapes, or one does, in mm", report_effects);
  add_option(measuring, "name", measured.name, "Only this modifier")->type_name("NAME");
  add_option(measuring, "--picture", measured.picture, "FILE.png",
             "The frame that it moves most: below the modifier, above it, and how far that is");

  const auto [baking, baked] =
      subverb(verb, "bake", "Another dataset, whose shapes are what the stack makes of these", bake);
  add_required(baking, "--out", baked.out, "DIR", "Its folder");
  add_option(baking, "--heldout-every", baked.heldout_every,
             "As of train: every Nth block of ten frames of a take is held out, and stays so in the new dataset")
      ->check(CLI::Range(2, 1000));

  const auto [reporting, reported] =
      subverb(verb, "report", "Frames of like poses whose shapes disagree, the worst first", report_disagreements);
  add_number(reporting, "--degrees", reported.degrees, 0.1, 180, "How far poses are alike");
  add_number(reporting, "--worst", reported.worst, 1, 10000, "Pairs to list");
  add_option(reporting, "--picture", reported.picture, "FILE.png",
             "The worst pair in one pose: the first, the second, and how far they are apart");

  const auto [exporting, exported] =
      subverb(verb, "export-frame", "A frame as a mesh, to be sculpted elsewhere", export_frame);
  add_frame(exporting, exported);
  add_required(exporting, "--out", exported.out, "FILE.obj|.glb", "Mesh to write; of a .glb the skeleton is posed")
      ->check(must_end_in(".obj|.glb"));

  const auto [importing, imported] =
      subverb(verb, "import-frame", "A sculpted mesh back, as a sculpt modifier", import_frame);
  add_frame(importing, imported);
  add_required(importing, "--mesh", imported.mesh, "MESH", "The mesh (.obj, .glb), its vertices in any order");
  add_option(importing, "--name", imported.name, "Modifier that it goes to, made where there is none")->required();
  add_number(importing, "--spread", imported.spread, 0, 1e4,
             "Degrees over which it fades in other poses; 0: this pose only");
}

}  // namespace bodyopt::cli
