// bodyopt curate: the stack of modifiers that a dataset's shapes are read through.
#include <nlohmann/json.hpp>

#include "assets/wording.h"
#include "cli/curate/curate_arguments.h"
#include "cli/curate/stack_report.h"
#include "dataset/stack_history.h"
#include "trainer/curate/bake.h"
#include "trainer/curate/edit_stack.h"
#include "trainer/curate/modifier_type.h"
#include "trainer/curate/prune.h"
#include "trainer/train/judge/heldout.h"

namespace bodyopt::cli {
namespace {

void bake(const CurateArguments& arguments) {
  make_folder(arguments.out);
  Dataset dataset = read_dataset(path_of(arguments));
  if (arguments.heldout_every > 0) hold_out_blocks(dataset, arguments.heldout_every);
  const ShapeStack stack(read_pose_database(dataset));
  say(stack.notes());
  const Dataset baked = bake_dataset(stack, arguments.out);
  std::size_t frames = 0;
  for (const DatasetTake& take : baked.takes) frames += take.frames.size();
  arguments.json.emit({{"dataset", arguments.out}, {"takes", baked.takes.size()}, {"frames", frames}},
                      format("wrote {}: {} frames of {} takes, whose shapes are what the modifiers made of them\n",
                             arguments.out, frames, baked.takes.size()));
}

void prune(const CurateArguments& arguments) {
  const PrunedFiles gone = prune_modifiers(path_of(arguments), arguments.history);
  arguments.json.emit({{"files", gone.files}, {"bytes", gone.bytes}},
                      format("removed {}, {:.1f} MiB\n", count_of(gone.files, "file", "files"),
                             static_cast<double>(gone.bytes) / (1 << 20)));
}

CLI::App& subverb(CLI::App& verb, const char* name, const char* description, const Arguments& arguments) {
  CLI::App& sub = add_verb(verb, name, description);
  add_option(sub, "dataset", arguments->dataset, "Dataset (folder or dataset.json)")->required()->type_name("DATASET");
  arguments->json.add(sub);
  return sub;
}

void add_name(CLI::App& sub, const Arguments& arguments) {
  add_option(sub, "name", arguments->name, "Name of the modifier")->required()->type_name("NAME");
}

void add_frame(CLI::App& sub, const Arguments& arguments) {
  add_option(sub, "--take", arguments->take, "Take")->required();
  add_option(sub, "--frame", arguments->frame, "Its frame")->required();
  add_flag(sub, "--unposed", arguments->unposed, "As the rest skin with the frame's displacements, not posed");
}

void add_scope(CLI::App& sub, const Arguments& arguments) {
  add_option(sub, "--strength", arguments->strength, "0 (nothing) to 1 (all)")->check(number_from(0, 1));
  add_option(sub, "--take", arguments->take, "Only frames of this take");
  add_option(sub, "--frames", arguments->frames, "Only these frames, e.g. 1001-1100x2");
  CLI::Option* near = add_option(sub, "--near", arguments->near, "Only poses near this frame of --take");
  add_option(sub, "--within", arguments->within, "Degrees that these are away at most")
      ->needs(near)
      ->check(number_from(0, 1e4));
  near->needs(sub.get_option("--within"));
  add_option(sub, "--near-joints", arguments->near_joints, "Joints that count for that (default: all)")->needs(near);
  add_option(sub, "--list", arguments->list, "Only the selection of this name in dataset.json");
  add_option(sub, "--joints", arguments->joints, "Only the skin of these joints");
  add_option(sub, "--muscles", arguments->muscles, "Only the skin over these muscles");
  add_option(sub, "--regions", arguments->regions, "Only these painted regions");
  add_option(sub, "--set", arguments->settings, "A parameter of the type, KEY=VALUE; null takes it away")
      ->type_name("KEY=VALUE");
}

void add_edits(CLI::App& verb) {
  const auto shared = std::make_shared<CurateArguments>();
  CLI::App& added = subverb(verb, "add", "Puts a modifier on top of the stack", shared);
  std::vector<std::string> types;
  std::string described;
  for (const ModifierType& type : modifier_types()) {
    types.push_back(type.name);
    described += std::string("\n  ") + type.name + ": " + type.what;
  }
  add_option(added, "type", shared->type, "Its type")->required()->check(CLI::IsMember(types));
  add_option(added, "--name", shared->name, "Its name (default: the type's)");
  add_scope(added, shared);
  added.footer("Types:" + described);
  added.callback([shared] { add_to_stack(*shared); });

  const auto edited = std::make_shared<CurateArguments>();
  CLI::App& changed = subverb(verb, "edit", "Changes a modifier; what is not named stays", edited);
  add_name(changed, edited);
  add_option(changed, "--name", edited->new_name, "Its new name");
  add_scope(changed, edited);
  add_flag(changed, "--all-frames", edited->everywhere, "All frames again");
  add_flag(changed, "--whole-skin", edited->whole_skin, "The whole skin again");
  const CLI::Option* strength = changed.get_option("--strength");
  changed.callback([edited, strength] { edit_stack(*edited, strength->count() > 0); });

  const auto named = std::make_shared<CurateArguments>();
  CLI::App& moved = subverb(verb, "move", "Moves a modifier to another place of the stack", named);
  add_name(moved, named);
  add_option(moved, "place", named->place, "Its place, from 1 (nearest to the raw shapes)")
      ->required()
      ->type_name("PLACE");
  moved.callback([named] {
    move_modifier(path_of(*named), named->name, named->place);
    emit_stack(*named);
  });
  for (const bool enabled : {true, false}) {
    const auto switched = std::make_shared<CurateArguments>();
    CLI::App& sub =
        subverb(verb, enabled ? "enable" : "disable", enabled ? "Switches a modifier on" : "Switches it off", switched);
    add_name(sub, switched);
    sub.callback([switched, enabled] {
      enable_modifier(path_of(*switched), switched->name, enabled);
      emit_stack(*switched);
    });
  }
  const auto gone = std::make_shared<CurateArguments>();
  CLI::App& removed = subverb(verb, "remove", "Takes a modifier off the stack; undo brings it back", gone);
  add_name(removed, gone);
  removed.callback([gone] {
    remove_modifier(path_of(*gone), gone->name);
    emit_stack(*gone);
  });
  for (const bool back : {true, false}) {
    const auto stepped = std::make_shared<CurateArguments>();
    subverb(verb, back ? "undo" : "redo", back ? "Takes the last edit back" : "Does what was undone again", stepped)
        .callback([stepped, back] {
          back ? undo_modifiers(path_of(*stepped)) : redo_modifiers(path_of(*stepped));
          emit_stack(*stepped);
        });
  }
}

}  // namespace

void add_curate(CLI::App& app) {
  CLI::App& verb = add_verb(app, "curate", "Modifiers that a dataset's shapes are read through, all of them undoable");
  verb.require_subcommand(1);
  const auto listed = std::make_shared<CurateArguments>();
  subverb(verb, "list", "The stack, from the raw shapes upwards", listed).callback([listed] { emit_stack(*listed); });
  add_edits(verb);

  const auto pruned = std::make_shared<CurateArguments>();
  CLI::App& sub_prune = subverb(
      verb, "prune", "Removes caches, and files that neither the stack, its history nor exported frames name", pruned);
  add_flag(
      sub_prune, "--history", pruned->history,
      "The history and what was exported, too: no edit before this can be undone, and a mesh is of its frame as it is");
  sub_prune.callback([pruned] { prune(*pruned); });

  const auto measured = std::make_shared<CurateArguments>();
  CLI::App& sub_diff = subverb(verb, "diff", "What every modifier does to the shapes, or one does, in mm", measured);
  add_option(sub_diff, "name", measured->name, "Only this modifier")->type_name("NAME");
  add_option(sub_diff, "--picture", measured->picture, "FILE.png",
             "The frame that it moves most: below the modifier, above it, and how far that is");
  sub_diff.callback([measured] { report_effects(*measured); });

  const auto baked = std::make_shared<CurateArguments>();
  CLI::App& sub_bake = subverb(verb, "bake", "Another dataset, whose shapes are what the stack makes of these", baked);
  add_option(sub_bake, "--out", baked->out, "Its folder")->required()->type_name("DIR");
  add_option(sub_bake, "--heldout-every", baked->heldout_every,
             "As of train: every Nth block of ten frames of a take is held out, and stays so in the new dataset")
      ->check(CLI::Range(2, 1000));
  sub_bake.callback([baked] { bake(*baked); });

  const auto reported = std::make_shared<CurateArguments>();
  CLI::App& sub_report =
      subverb(verb, "report", "Frames of like poses whose shapes disagree, the worst first", reported);
  add_option(sub_report, "--degrees", reported->degrees, "How far poses are alike")
      ->capture_default_str()
      ->check(number_from(0.1, 180));
  add_option(sub_report, "--worst", reported->worst, "Pairs to list")
      ->capture_default_str()
      ->check(CLI::Range(1, 10000));
  add_option(sub_report, "--picture", reported->picture, "FILE.png",
             "The worst pair in one pose: the first, the second, and how far they are apart");
  sub_report.callback([reported] { report_disagreements(*reported); });

  const auto exported = std::make_shared<CurateArguments>();
  CLI::App& sub_export = subverb(verb, "export-frame", "A frame as a mesh, to be sculpted elsewhere", exported);
  add_frame(sub_export, exported);
  add_option(sub_export, "--out", exported->out, "Mesh to write; of a .glb the skeleton is posed")
      ->required()
      ->type_name("FILE.obj|FILE.glb")
      ->check(
          [](const std::string& name) { return name.ends_with(".glb") ? std::string() : must_end_in(".obj")(name); });
  sub_export.callback([exported] { export_frame(*exported); });

  const auto imported = std::make_shared<CurateArguments>();
  CLI::App& sub_import = subverb(verb, "import-frame", "A sculpted mesh back, as a sculpt modifier", imported);
  add_frame(sub_import, imported);
  add_option(sub_import, "--mesh", imported->mesh, "The mesh (.obj, .glb), its vertices in any order")
      ->required()
      ->type_name("MESH");
  add_option(sub_import, "--name", imported->name, "Modifier that it goes to, made where there is none")->required();
  add_option(sub_import, "--spread", imported->spread, "Degrees over which it fades in other poses; 0: this pose only")
      ->capture_default_str()
      ->check(number_from(0, 1e4));
  sub_import.callback([imported] { import_frame(*imported); });
}

}  // namespace bodyopt::cli
