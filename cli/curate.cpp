// bodyopt curate: the stack of modifiers that a dataset's shapes are read through.
#include <algorithm>
#include <filesystem>

#include "assets/clip_source.h"
#include "assets/pc2.h"
#include "assets/wording.h"
#include "cli/arguments/common.h"
#include "dataset/stack_history.h"
#include "geometry/table_rows.h"
#include "report/pictures.h"
#include "runtime/core/error.h"
#include "trainer/curate/bake.h"
#include "trainer/curate/consistency_report.h"
#include "trainer/curate/edit_stack.h"
#include "trainer/curate/exported_frames.h"
#include "trainer/curate/frame_files.h"
#include "trainer/curate/frame_sculpting.h"
#include "trainer/curate/local_models.h"
#include "trainer/curate/modifier_scope.h"
#include "trainer/curate/modifier_type.h"
#include "trainer/curate/prune.h"
#include "trainer/curate/sculpted_frames.h"
#include "trainer/train/judge/heldout.h"

namespace bodyopt::cli {
namespace {

namespace fs = std::filesystem;

struct CurateArguments {
  std::string dataset, name, type, new_name, out, take, frames, list, mesh, picture;
  std::vector<std::string> settings, joints, muscles, regions, near_joints;
  double strength = 1, within = -1, degrees = kAlikeDegrees, spread = 30;
  int near = 0, frame = 0, worst = 10, heldout_every = 0;
  std::size_t place = 1;
  bool history = false, unposed = false, everywhere = false, whole_skin = false;
  JsonOption json;
};

using Arguments = std::shared_ptr<CurateArguments>;

fs::path path_of(const CurateArguments& arguments) {
  const fs::path given = arguments.dataset;
  return given.extension() == ".json" ? given : given / "dataset.json";
}

// Of a database, how many frames of each take a modifier's selections name.
struct TakenFrames {
  std::vector<std::pair<std::string, std::size_t>> by_take;  // those of which it takes any
  std::size_t taken = 0, all = 0;
};

TakenFrames taken_frames(const PoseDatabase& database, const Modifier& modifier) {
  const std::vector<char> selected = selected_frames(database, modifier.frames, "modifier '" + modifier.name + "'");
  TakenFrames result{{}, 0, selected.size()};
  for (std::size_t n = 0; n < selected.size(); ++n) {
    if (!selected[n]) continue;
    const std::string& take = database.takes[static_cast<std::size_t>(database.frames[n].take)];
    if (result.by_take.empty() || result.by_take.back().first != take) result.by_take.emplace_back(take, 0);
    ++result.by_take.back().second;
    ++result.taken;
  }
  return result;
}

Json to_json(const TakenFrames& frames) {
  Json takes = Json::object();
  for (const auto& [take, count] : frames.by_take) takes[take] = count;
  return {{"taken", frames.taken}, {"all", frames.all}, {"takes", takes}};
}

// "drops 127 of 161 frames (rom 120, walk 7)"; "would drop" where it is switched off.
std::string text_of(const TakenFrames& frames, const ModifierType& type, bool enabled) {
  const char* verb = "take";
  if (type.effect == ModifierType::Effect::drop) verb = "drop";
  if (type.effect == ModifierType::Effect::weight) verb = "weigh";
  const std::string does = enabled ? std::string(verb) + "s" : std::string("would ") + verb;
  std::string takes;
  for (const auto& [take, count] : frames.by_take) {
    takes += (takes.empty() ? "" : ", ") + take + " " + std::to_string(count);
  }
  return format("%s %zu of %s (%s)", does.c_str(), frames.taken, count_of(frames.all, "frame", "frames").c_str(),
                takes.c_str());
}

// "radius_mm=40, sculpts: 2"; what is long, as a mesh's displacements, is counted.
std::string short_parameters(const Json& parameters) {
  std::string text;
  for (const auto& [key, value] : parameters.items()) {
    text += (text.empty() ? "" : ", ") + key;
    text += value.is_structured() ? ": " + std::to_string(value.size()) : "=" + value.dump();
  }
  return text;
}

// Null, with a warning, where the takes cannot be read: the stack itself can be told all the same.
std::optional<PoseDatabase> readable_database(const Dataset& dataset) {
  try {
    return read_pose_database(dataset);
  } catch (const Error& error) {
    say({std::string("how many frames modifiers take is not known: ") + error.what()});
    return std::nullopt;
  }
}

// As readable_database().
std::optional<TakenFrames> readable_frames(const std::optional<PoseDatabase>& database, const Modifier& modifier) {
  if (!database || find_modifier_type(modifier.type) == nullptr) return std::nullopt;
  try {
    return taken_frames(*database, modifier);
  } catch (const Error& error) {
    say({error.what()});
    return std::nullopt;
  }
}

// The stack for programs and for people.
struct StackReport {
  Json list;
  std::string text;
};

StackReport report_stack(const Dataset& dataset, const std::optional<PoseDatabase>& database) {
  StackReport report{bodyopt::to_json(dataset.modifiers), ""};
  if (dataset.modifiers.empty()) return {report.list, "no modifiers: the shapes are read as they are\n"};
  report.text = format("%3s  %-20s %-12s %-4s %8s  %s\n", "", "modifier", "type", "", "strength", "frames; mask");
  for (std::size_t k = 0; k < dataset.modifiers.size(); ++k) {
    const Modifier& modifier = dataset.modifiers[k];
    const ModifierType* type = find_modifier_type(modifier.type);
    report.list[k]["known"] = type != nullptr;
    report.text += format("%3zu  %-20s %-12s %-4s %8.2f  %s; %s%s\n", k + 1, modifier.name.c_str(),
                          modifier.type.c_str(), modifier.enabled ? "on" : "off", modifier.strength,
                          modifier.frames.empty() ? "all" : modifier.frames.dump().c_str(),
                          modifier.mask.empty() ? "all" : modifier.mask.dump().c_str(),
                          type ? "" : "  (of a newer version: not applied)");
    std::string details = short_parameters(modifier.parameters);
    if (const std::optional<TakenFrames> frames = readable_frames(database, modifier)) {
      report.list[k]["frame_counts"] = to_json(*frames);
      details = text_of(*frames, *type, modifier.enabled) + (details.empty() ? "" : "; ") + details;
    }
    if (!details.empty()) report.text += "     " + details + "\n";
  }
  return report;
}

// The stack as it is now: what every edit ends with. `database`: none where it cannot be read.
void emit_stack(const CurateArguments& arguments, const Dataset& dataset, const std::optional<PoseDatabase>& database) {
  const StackReport report = report_stack(dataset, database);
  arguments.json.emit({{"dataset", path_of(arguments).string()}, {"modifiers", report.list}}, report.text);
}

// The same after what needed no database.
void emit_stack(const CurateArguments& arguments) {
  const Dataset dataset = read_dataset(path_of(arguments));
  emit_stack(arguments, dataset, dataset.modifiers.empty() ? std::nullopt : readable_database(dataset));
}

// KEY=VALUE, the value JSON or else text.
Json parameters_of(const std::vector<std::string>& settings) {
  Json parameters = Json::object();
  for (const std::string& setting : settings) {
    const std::size_t equals = setting.find('=');
    if (equals == std::string::npos || equals == 0) {
      throw Error(ErrorKind::usage, "--set takes KEY=VALUE, not '" + setting + "'");
    }
    const Json value = Json::parse(setting.substr(equals + 1), nullptr, false);
    parameters[setting.substr(0, equals)] = value.is_discarded() ? Json(setting.substr(equals + 1)) : value;
  }
  return parameters;
}

// None where no option says which frames.
std::optional<Json> selections_of(const CurateArguments& arguments) {
  Json selection = Json::object();
  if (arguments.within >= 0) {
    if (arguments.take.empty()) throw Error(ErrorKind::usage, "--near FRAME needs --take, whose frame it is");
    selection["near"] = {{"take", arguments.take}, {"frame", arguments.near}, {"degrees", arguments.within}};
    if (!arguments.near_joints.empty()) selection["near"]["joints"] = arguments.near_joints;
  } else if (!arguments.list.empty()) {
    selection["list"] = arguments.list;
  } else {
    if (!arguments.take.empty()) selection["take"] = arguments.take;
    if (!arguments.frames.empty()) selection["frames"] = arguments.frames;
  }
  if (arguments.everywhere) return Json::array();
  if (selection.empty()) return std::nullopt;
  return Json::array({selection});
}

std::optional<Json> mask_of(const CurateArguments& arguments) {
  Json mask = Json::object();
  if (!arguments.joints.empty()) mask["joints"] = arguments.joints;
  if (!arguments.muscles.empty()) mask["muscles"] = arguments.muscles;
  if (!arguments.regions.empty()) mask["regions"] = arguments.regions;
  if (arguments.whole_skin) return Json::object();
  if (mask.empty()) return std::nullopt;
  return mask;
}

void add(const CurateArguments& arguments) {
  Modifier modifier{.name = arguments.name, .type = arguments.type, .strength = arguments.strength};
  modifier.frames = selections_of(arguments).value_or(Json::array());
  modifier.mask = mask_of(arguments).value_or(Json::object());
  modifier.parameters = parameters_of(arguments.settings);
  const std::optional<PoseDatabase> database = add_modifier(path_of(arguments), modifier);
  emit_stack(arguments, database->dataset, database);
}

void edit(const CurateArguments& arguments, bool strength_given) {
  ModifierChange change;
  if (!arguments.new_name.empty()) change.name = arguments.new_name;
  if (strength_given) change.strength = arguments.strength;
  change.frames = selections_of(arguments);
  change.mask = mask_of(arguments);
  change.parameters = parameters_of(arguments.settings);
  const std::optional<PoseDatabase> database = change_modifier(path_of(arguments), arguments.name, change);
  emit_stack(arguments, database->dataset, database);
}

std::string frame_text(const PoseDatabase& database, std::size_t n) {
  const DatabaseFrame& frame = database.frames[n];
  return database.takes[static_cast<std::size_t>(frame.take)] + " " + std::to_string(frame.frame);
}

Json frame_json(const PoseDatabase& database, std::size_t n) {
  const DatabaseFrame& frame = database.frames[n];
  return {{"take", database.takes[static_cast<std::size_t>(frame.take)]}, {"frame", frame.frame}};
}

constexpr double kFinestScale = 0.1;  // mm: of less nothing is to be seen

// Two shapes in one pose, and the second in the colours of how far it is from the first (hottest at scale_mm), from the
// side where that is most.
void draw_apart(const Character& character, const Positions& before, const Positions& after, double scale_mm,
                const std::string& path) {
  constexpr std::uint32_t kWidth = 500, kHeight = 700;
  const std::vector<float> first = floats_of(before), second = floats_of(after);
  const PosePair drawn{
      {character.triangles.data(), static_cast<std::size_t>(character.triangles.size())}, first, second};
  Renderer renderer;
  const Camera camera = frame_pose(drawn, towards_worst(drawn), float{kWidth} / kHeight);
  write_png(comparison(renderer, drawn, scale_mm, camera, kWidth, kHeight), path);
}

// The worst pair in one pose, and in colour how far apart the shapes are in its region.
std::string draw_pair(const ShapeStack& stack, const DisagreeingPair& pair, const std::string& path) {
  const PairInOnePose shapes = in_one_pose(stack, pair);
  const double scale = std::max(kFinestScale, pair.most_mm);
  draw_apart(stack.database().character, shapes.first, shapes.second, scale, path);
  return format(
      "wrote %s: %s; the same with what %s, whose pose is %.1f degrees off, has in the region %s that poses do not "
      "explain; how far that is, darkest at %.2f mm\n",
      path.c_str(), frame_text(stack.database(), pair.first).c_str(), frame_text(stack.database(), pair.second).c_str(),
      pair.pose_degrees, pair.region.c_str(), scale);
}

// The frame that a modifier moves most, below it and above.
std::string draw_effect(const ShapeStack& stack, const ModifierEffect& effect, const std::string& path) {
  if (effect.frames.empty()) {
    throw Error(ErrorKind::usage,
                "--picture shows what a modifier moves, and '" + effect.name +
                    "' moves no vertex of any frame: is it switched off, or of a type that moves none?");
  }
  const std::vector<Modifier>& modifiers = stack.database().dataset.modifiers;
  const auto place =
      static_cast<std::size_t>(std::ranges::find(modifiers, effect.name, &Modifier::name) - modifiers.begin());
  const UnposedSpace::Frame space = stack.space().frame(stack.database().frames[effect.worst].pose);
  const auto left_by = [&](std::size_t count) { return space.shape(stack.offsets(effect.worst, count)); };
  const Positions before = left_by(place), after = left_by(place + 1);
  const double scale = std::max(kFinestScale, 1e3 * (after - before).rowwise().norm().maxCoeff());
  draw_apart(stack.database().character, before, after, scale, path);
  return format("wrote %s: %s before '%s' and after; how far that is, darkest at %.2f mm\n", path.c_str(),
                frame_text(stack.database(), effect.worst).c_str(), effect.name.c_str(), scale);
}

[[noreturn]] void refuse_picture_of_all(const std::vector<Modifier>& modifiers) {
  std::vector<std::string> names;
  for (const Modifier& modifier : modifiers) names.push_back(modifier.name);
  throw Error(
      ErrorKind::usage,
      "--picture shows what one modifier moves: name it, as in 'curate diff DATASET NAME --picture FILE.png'; the "
      "stack has " +
          list_names(names));
}

// What of the type consistency reaches its cap in many frames hardly takes history alone.
std::vector<std::string> capped_notes(const std::vector<Modifier>& modifiers,
                                      const std::vector<ModifierEffect>& effects) {
  constexpr std::size_t kMany = 20;  // one frame of so many
  std::vector<std::string> notes;
  for (const ModifierEffect& effect : effects) {
    const Modifier& modifier = *std::ranges::find(modifiers, effect.name, &Modifier::name);
    if (modifier.type != "consistency") continue;
    const double cap = modifier.parameters.value("cap_mm", kUsualCapMm) * modifier.strength;
    const auto capped = static_cast<std::size_t>(
        std::ranges::count_if(effect.frames, [&](const FrameEffect& frame) { return frame.max_mm > 0.99 * cap; }));
    if (capped == 0 || capped * kMany < effect.frames.size()) continue;
    notes.push_back(
        format("'%s' moves %zu of %zu frames as far as cap_mm lets it (%.3g mm): passes seldom disagree by so "
               "much; compare the held-out errors with it and without",
               effect.name.c_str(), capped, effect.frames.size(), cap));
  }
  return notes;
}

void diff(const CurateArguments& arguments) {
  const ShapeStack stack(read_pose_database(read_dataset(path_of(arguments))));
  say(stack.notes());
  if (!arguments.picture.empty() && arguments.name.empty()) refuse_picture_of_all(stack.database().dataset.modifiers);
  const std::vector<ModifierEffect> effects = measure_modifiers(stack, arguments.name);
  std::string text = format("%-20s %8s %10s %10s   %s\n", "modifier", "frames", "RMS mm", "max mm", "most of all");
  Json list = Json::array();
  for (const ModifierEffect& effect : effects) {
    text += format("%-20s %8zu %10.3f %10.3f   %s\n", effect.name.c_str(), effect.frames.size(), effect.rms_mm,
                   effect.max_mm, effect.frames.empty() ? "" : frame_text(stack.database(), effect.worst).c_str());
    Json frames = Json::array();
    for (const FrameEffect& frame : effect.frames) {
      frames.push_back(frame_json(stack.database(), frame.frame));
      frames.back().update({{"rms_mm", frame.rms_mm}, {"max_mm", frame.max_mm}});
    }
    list.push_back({{"name", effect.name}, {"rms_mm", effect.rms_mm}, {"max_mm", effect.max_mm}, {"frames", frames}});
    const Modifier& modifier = *std::ranges::find(stack.database().dataset.modifiers, effect.name, &Modifier::name);
    const ModifierType* type = find_modifier_type(modifier.type);
    if (type == nullptr || type->effect == ModifierType::Effect::shape) continue;
    const TakenFrames taken = taken_frames(stack.database(), modifier);
    list.back()["frame_counts"] = to_json(taken);
    text += format("%-20s %s\n", "", text_of(taken, *type, modifier.enabled).c_str());
  }
  say(capped_notes(stack.database().dataset.modifiers, effects));
  if (!arguments.picture.empty()) text += draw_effect(stack, effects.front(), arguments.picture);
  arguments.json.emit({{"modifiers", list}}, text);
}

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
                      format("wrote %s: %zu frames of %zu takes, whose shapes are what the modifiers made of them\n",
                             arguments.out.c_str(), frames, baked.takes.size()));
}

void prune(const CurateArguments& arguments) {
  const PrunedFiles gone = prune_modifiers(path_of(arguments), arguments.history);
  arguments.json.emit({{"files", gone.files}, {"bytes", gone.bytes}},
                      format("removed %s, %.1f MiB\n", count_of(gone.files, "file", "files").c_str(),
                             static_cast<double>(gone.bytes) / (1 << 20)));
}

void report(const CurateArguments& arguments) {
  const ShapeStack stack(read_pose_database(read_dataset(path_of(arguments))));
  say(stack.notes());
  const PoseDatabase& database = stack.database();
  const ConsistencyReport found =
      report_consistency(stack, arguments.degrees, static_cast<std::size_t>(arguments.worst));
  std::string text;
  if (!found.pairs.empty()) {
    text = format("%-20s %-20s %-24s %9s %9s %9s\n", "frame", "and frame", "region", "apart mm", "most mm", "degrees");
  }
  Json pairs = Json::array(), regions = Json::array();
  for (const DisagreeingPair& pair : found.pairs) {
    text += format("%-20s %-20s %-24s %9.2f %9.2f %9.1f\n", frame_text(database, pair.first).c_str(),
                   frame_text(database, pair.second).c_str(), pair.region.c_str(), pair.apart_mm, pair.most_mm,
                   pair.pose_degrees);
    pairs.push_back({{"first", frame_json(database, pair.first)},
                     {"second", frame_json(database, pair.second)},
                     {"region", pair.region},
                     {"apart_mm", pair.apart_mm},
                     {"most_mm", pair.most_mm},
                     {"pose_degrees", pair.pose_degrees}});
  }
  text += format("%s%-24s %11s %9s %10s %12s\n", text.empty() ? "" : "\n", "region", "neighbours", "alone", "same pose",
                 "deviation mm");
  for (const RegionAgreement& region : found.regions) {
    text += format("%-24s %11.0f %8.0f%% %9.0f%% %12.3f\n", region.region.c_str(), region.neighbours,
                   100 * region.single, 100 * region.same_pose, region.deviation_mm);
    regions.push_back({{"region", region.region},
                       {"neighbours", region.neighbours},
                       {"alone", region.single},
                       {"same_pose", region.same_pose},
                       {"deviation_mm", region.deviation_mm}});
  }
  const auto untold = static_cast<std::size_t>(
      std::ranges::count_if(found.regions, [](const RegionAgreement& region) { return region.same_pose == 0; }));
  if (untold > 0) {
    text += format(
        "%s no frame in the same pose as one of another motion: too few neighbours to tell whether shapes "
        "disagree there\n",
        count_of(untold, "region has", "regions have").c_str());
  }
  if (found.pairs.empty()) {
    text += arguments.picture.empty()
                ? "no like poses have shapes that differ by more than their poses do\n"
                : "no like poses have shapes that differ by more than their poses do: there is no pair to draw\n";
  } else if (!arguments.picture.empty()) {
    text += draw_pair(stack, found.pairs.front(), arguments.picture);
  }
  Json frames = Json::array();
  for (std::size_t n = 0; n < found.frame_mm.size(); ++n) {
    frames.push_back(frame_json(database, n));
    frames.back()["deviation_mm"] = found.frame_mm[n];
  }
  arguments.json.emit({{"pairs", pairs}, {"regions", regions}, {"frames", frames}}, text);
}

// V x 3, as a frame went to the artist's tool.
Positions exported_skin(const ShapeStack& stack, std::size_t frame, const ExportedFrame& exported, bool unposed) {
  if (unposed) return exported.skin;
  const PoseDatabase& database = stack.database();
  return stack.space().frame(database.frames[frame].pose).shape(exported.skin - database.character.vertices);
}

// Returns the export's mark. The frame can be looked at and sculpted without, too: it comes back as a sculpt of what
// the frame is then.
std::string remember(const CurateArguments& arguments, const ShapeStack& stack, std::size_t frame,
                     const ExportedFrame& exported) {
  try {
    return keep_exported(path_of(arguments), stack, frame, exported);
  } catch (const Error& error) {
    say({std::string("import-frame will not know what was exported, should the stack change: ") + error.what()});
    return "";
  }
}

void export_frame(const CurateArguments& arguments) {
  require_writable(arguments.out);
  const ShapeStack stack(read_pose_database(read_dataset(path_of(arguments))));
  say(stack.notes());
  const Character& character = stack.database().character;
  const std::size_t frame = stack.database().find(arguments.take, arguments.frame, "export-frame");
  const ExportedFrame exported = exported_now(stack, frame);
  const Positions skin = arguments.unposed ? exported.skin : stack.shape(frame);
  const Pose& pose = stack.database().frames[frame].pose;
  const SkinSurface surface = frame_surface(stack.database());
  const std::string mark = remember(arguments, stack, frame, exported);
  if (lower_case_extension(arguments.out) == ".glb") {
    write_frame_gltf(character, surface, skin, arguments.unposed ? bind_pose(character.skeleton) : pose, arguments.out,
                     mark);
  } else {
    write_frame_obj(character, surface, output_from_welded(character, skin), arguments.out, mark);
  }
  arguments.json.emit({{"mesh", arguments.out}, {"vertices", character.output_count()}},
                      format("wrote %s: %u vertices\n", arguments.out.c_str(), character.output_count()));
}

// Why two stacks make different shapes of a frame, but for what is sculpted in `name`.
std::string what_differs(std::vector<Modifier> before, std::vector<Modifier> now, const std::string& name) {
  const auto forget_sculpts = [&](std::vector<Modifier>& modifiers) {
    const auto own = std::ranges::find(modifiers, name, &Modifier::name);
    if (own != modifiers.end()) own->parameters = Json::object();
    return own != modifiers.end();
  };
  const bool was_there = forget_sculpts(before), is_there = forget_sculpts(now);
  if (was_there != is_there) std::erase(was_there ? before : now, Modifier{.name = name, .type = "sculpt"});
  const std::vector<std::string> names = names_that_differ(before, now);
  if (!names.empty()) return "modifiers " + list_names(names);
  return before == now ? "its raw shape" : "the order of the modifiers";
}

// What the artist should know where the frame is another by now, but for what the modifier itself makes of it.
std::vector<std::string> changes_since(const ShapeStack& stack, std::size_t frame, const ExportedFrame& exported,
                                       const std::string& name) {
  constexpr double kChanged = 1e-5;  // metres
  const PoseDatabase& database = stack.database();
  const std::vector<Modifier>& modifiers = database.dataset.modifiers;
  const auto without = [&](const ExportedFrame& there) {
    return Positions(there.skin - sculpted_by(database, there.modifiers, name, frame));
  };
  const double most = (without(exported_now(stack, frame)) - without(exported)).rowwise().norm().maxCoeff();
  if (most < kChanged) return {};
  return {format(
      "%s has changed by %.2f mm since the mesh was exported (%s): what was sculpted is added to what it is "
      "now",
      frame_text(database, frame).c_str(), 1e3 * most, what_differs(exported.modifiers, modifiers, name).c_str())};
}

// How far the sculpt of a frame reaches, now that it is in the stack; none where the modifier has no sculpt of it.
struct SculptReach {
  double most_mm = 0;      // by the modifier's strength and mask
  double degrees = 0;      // of its spread
  std::size_t others = 0;  // frames that take of it
};

std::optional<SculptReach> reach_of(const PoseDatabase& database, const std::string& name, std::size_t frame) {
  const auto modifier = std::ranges::find(database.dataset.modifiers, name, &Modifier::name);
  if (modifier == database.dataset.modifiers.end()) return std::nullopt;
  const SculptedFrames sculpted(database,
                                JsonObject(modifier->parameters, database.dataset.folder / "dataset.json", name), name);
  const auto own = std::ranges::find(sculpted.sculpts(), frame, &SculptedFrame::frame);
  if (own == sculpted.sculpts().end()) return std::nullopt;
  const Eigen::VectorXd mask = skin_mask(database, modifier->mask, name);
  SculptReach reach{1e3 * modifier->strength * own->delta.rowwise().norm().cwiseProduct(mask).maxCoeff(),
                    sculpted.spread()};
  const auto number = static_cast<std::size_t>(own - sculpted.sculpts().begin());
  for (std::size_t n = 0; n < database.frames.size(); ++n) {
    if (n != frame && sculpted.weights(n)[number] > 0) ++reach.others;
  }
  return reach;
}

// The stack with the sculpt in it, and what the sculpt moves.
void emit_sculpt(const CurateArguments& arguments) {
  std::optional<PoseDatabase> read = read_pose_database(read_dataset(path_of(arguments)));
  auto [list, text] = report_stack(read->dataset, read);
  const ShapeStack stack(std::move(*read));
  const PoseDatabase& database = stack.database();
  const std::size_t frame = database.find(arguments.take, arguments.frame, "import-frame");
  Json result = {{"dataset", path_of(arguments).string()}, {"modifiers", list}};
  const std::optional<SculptReach> reach = reach_of(database, arguments.name, frame);
  if (reach) {
    result["sculpt"] = {{"max_mm", reach->most_mm}, {"other_frames", reach->others}};
    text += format("the sculpt moves %s by %.2f mm at most, and %s within %g degrees by less\n",
                   frame_text(database, frame).c_str(), reach->most_mm,
                   count_of(reach->others, "other frame", "other frames").c_str(), reach->degrees);
  }
  const std::string hidden = why_not_shown(database, arguments.name, frame);
  if (!hidden.empty())
    say({"the modifier '" + arguments.name + "' " + hidden + ": the frame is not what was sculpted"});
  arguments.json.emit(result, text);
}

// Where the mesh alone does not tell what it was made of.
std::string alike_note(const PoseDatabase& database, std::size_t frame, const ExportedFrame& taken,
                       std::size_t others) {
  std::vector<std::string> names;
  for (const Modifier& modifier : taken.modifiers) names.push_back(modifier.name);
  return format(
      "the mesh does not say which export of %s it is of (its name is another), and lies on %s as well: taken is the "
      "latest, which was made %s",
      frame_text(database, frame).c_str(), count_of(others, "other", "others").c_str(),
      names.empty() ? "without modifiers" : ("by the modifiers " + list_names(names)).c_str());
}

void import_frame(const CurateArguments& arguments) {
  const ShapeStack stack(read_pose_database(read_dataset(path_of(arguments))));
  const PoseDatabase& database = stack.database();
  const std::size_t frame = database.find(arguments.take, arguments.frame, "import-frame");
  require_sculpt(database.dataset.modifiers, arguments.name);
  KeptExports kept = kept_exports(stack, frame, arguments.name);
  say(kept.notes);
  std::vector<ExportedFrame>& exports = kept.frames;
  exports.push_back(exported_now(stack, frame));
  std::vector<WrittenSkin> skins;
  for (const ExportedFrame& exported : exports) {
    skins.push_back({exported_skin(stack, frame, exported, arguments.unposed), exported.mark});
  }
  const FrameMesh mesh = read_frame_mesh(database.character, frame_surface(database).texture, skins, arguments.mesh);
  const ExportedFrame& exported = exports[mesh.of];
  if (mesh.was_turned) {
    say(
        {"the mesh lies turned, as programs write it whose up is another axis (Z, in Blender): it was turned back to "
         "where it was exported"});
  }
  if (mesh.alike > 0) say({alike_note(database, frame, exported, mesh.alike)});
  say(changes_since(stack, frame, exported, arguments.name));
  say(add_sculpt(path_of(arguments), arguments.name, arguments.take, arguments.frame, exported, mesh.positions,
                 arguments.unposed, arguments.spread));
  emit_sculpt(arguments);
}

CLI::App& subverb(CLI::App& verb, const char* name, const char* description, const Arguments& arguments) {
  CLI::App& sub = *verb.add_subcommand(name, description);
  sub.add_option("dataset", arguments->dataset, "Dataset (folder or dataset.json)")->required()->type_name("DATASET");
  arguments->json.add(sub);
  return sub;
}

void add_name(CLI::App& sub, const Arguments& arguments) {
  sub.add_option("name", arguments->name, "Name of the modifier")->required()->type_name("NAME");
}

void add_frame(CLI::App& sub, const Arguments& arguments) {
  sub.add_option("--take", arguments->take, "Take")->required();
  sub.add_option("--frame", arguments->frame, "Its frame")->required();
  sub.add_flag("--unposed", arguments->unposed, "As the rest skin with the frame's displacements, not posed");
}

void add_scope(CLI::App& sub, const Arguments& arguments) {
  sub.add_option("--strength", arguments->strength, "0 (nothing) to 1 (all)")->check(number_from(0, 1));
  sub.add_option("--take", arguments->take, "Only frames of this take");
  sub.add_option("--frames", arguments->frames, "Only these frames, e.g. 1001-1100x2");
  CLI::Option* near = sub.add_option("--near", arguments->near, "Only poses near this frame of --take");
  sub.add_option("--within", arguments->within, "Degrees that these are away at most")
      ->needs(near)
      ->check(number_from(0, 1e4));
  near->needs(sub.get_option("--within"));
  sub.add_option("--near-joints", arguments->near_joints, "Joints that count for that (default: all)")->needs(near);
  sub.add_option("--list", arguments->list, "Only the selection of this name in dataset.json");
  sub.add_option("--joints", arguments->joints, "Only the skin of these joints");
  sub.add_option("--muscles", arguments->muscles, "Only the skin over these muscles");
  sub.add_option("--regions", arguments->regions, "Only these painted regions");
  sub.add_option("--set", arguments->settings, "A parameter of the type, KEY=VALUE; null takes it away")
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
  added.add_option("type", shared->type, "Its type")->required()->check(CLI::IsMember(types));
  added.add_option("--name", shared->name, "Its name (default: the type's)");
  add_scope(added, shared);
  added.footer("Types:" + described);
  added.callback([shared] { add(*shared); });

  const auto edited = std::make_shared<CurateArguments>();
  CLI::App& changed = subverb(verb, "edit", "Changes a modifier; what is not named stays", edited);
  add_name(changed, edited);
  changed.add_option("--name", edited->new_name, "Its new name");
  add_scope(changed, edited);
  changed.add_flag("--all-frames", edited->everywhere, "All frames again");
  changed.add_flag("--whole-skin", edited->whole_skin, "The whole skin again");
  const CLI::Option* strength = changed.get_option("--strength");
  changed.callback([edited, strength] { edit(*edited, strength->count() > 0); });

  const auto named = std::make_shared<CurateArguments>();
  CLI::App& moved = subverb(verb, "move", "Moves a modifier to another place of the stack", named);
  add_name(moved, named);
  moved.add_option("place", named->place, "Its place, from 1 (nearest to the raw shapes)")
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
  CLI::App& verb =
      *app.add_subcommand("curate", "Modifiers that a dataset's shapes are read through, all of them undoable");
  verb.require_subcommand(1);
  const auto listed = std::make_shared<CurateArguments>();
  subverb(verb, "list", "The stack, from the raw shapes upwards", listed).callback([listed] { emit_stack(*listed); });
  add_edits(verb);

  const auto pruned = std::make_shared<CurateArguments>();
  CLI::App& sub_prune = subverb(
      verb, "prune", "Removes caches, and files that neither the stack, its history nor exported frames name", pruned);
  sub_prune.add_flag(
      "--history", pruned->history,
      "The history and what was exported, too: no edit before this can be undone, and a mesh is of its frame as it is");
  sub_prune.callback([pruned] { prune(*pruned); });

  const auto measured = std::make_shared<CurateArguments>();
  CLI::App& sub_diff = subverb(verb, "diff", "What every modifier does to the shapes, or one does, in mm", measured);
  sub_diff.add_option("name", measured->name, "Only this modifier")->type_name("NAME");
  sub_diff
      .add_option("--picture", measured->picture,
                  "The frame that it moves most: below the modifier, above it, and how far that is")
      ->type_name("FILE.png")
      ->check(must_end_in(".png"));
  sub_diff.callback([measured] { diff(*measured); });

  const auto baked = std::make_shared<CurateArguments>();
  CLI::App& sub_bake = subverb(verb, "bake", "Another dataset, whose shapes are what the stack makes of these", baked);
  sub_bake.add_option("--out", baked->out, "Its folder")->required()->type_name("DIR");
  sub_bake
      .add_option("--heldout-every", baked->heldout_every,
                  "As of train: every Nth block of ten frames of a take is held out, and stays so in the new dataset")
      ->check(CLI::Range(2, 1000));
  sub_bake.callback([baked] { bake(*baked); });

  const auto reported = std::make_shared<CurateArguments>();
  CLI::App& sub_report =
      subverb(verb, "report", "Frames of like poses whose shapes disagree, the worst first", reported);
  sub_report.add_option("--degrees", reported->degrees, "How far poses are alike")
      ->capture_default_str()
      ->check(number_from(0.1, 180));
  sub_report.add_option("--worst", reported->worst, "Pairs to list")
      ->capture_default_str()
      ->check(CLI::Range(1, 10000));
  sub_report
      .add_option("--picture", reported->picture,
                  "The worst pair in one pose: the first, the second, and how far they are apart")
      ->type_name("FILE.png")
      ->check(must_end_in(".png"));
  sub_report.callback([reported] { report(*reported); });

  const auto exported = std::make_shared<CurateArguments>();
  CLI::App& sub_export = subverb(verb, "export-frame", "A frame as a mesh, to be sculpted elsewhere", exported);
  add_frame(sub_export, exported);
  sub_export.add_option("--out", exported->out, "Mesh to write; of a .glb the skeleton is posed")
      ->required()
      ->type_name("FILE.obj|FILE.glb")
      ->check(
          [](const std::string& name) { return name.ends_with(".glb") ? std::string() : must_end_in(".obj")(name); });
  sub_export.callback([exported] { export_frame(*exported); });

  const auto imported = std::make_shared<CurateArguments>();
  CLI::App& sub_import = subverb(verb, "import-frame", "A sculpted mesh back, as a sculpt modifier", imported);
  add_frame(sub_import, imported);
  sub_import.add_option("--mesh", imported->mesh, "The mesh (.obj, .glb), its vertices in any order")
      ->required()
      ->type_name("MESH");
  sub_import.add_option("--name", imported->name, "Modifier that it goes to, made where there is none")->required();
  sub_import.add_option("--spread", imported->spread, "Degrees over which it fades in other poses; 0: this pose only")
      ->capture_default_str()
      ->check(number_from(0, 1e4));
  sub_import.callback([imported] { import_frame(*imported); });
}

}  // namespace bodyopt::cli
