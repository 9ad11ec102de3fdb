#include "cli/curate/stack_report.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <vector>

#include "base/wording.h"
#include "cli/curate/curate_arguments.h"
#include "dataset/modifier.h"
#include "geometry/mesh.h"
#include "report/pictures.h"
#include "runtime/core/error.h"
#include "trainer/curate/consistency.h"
#include "trainer/curate/modifier_scope.h"
#include "trainer/curate/shape_stack.h"

namespace bodyopt::cli {
namespace {

// "radius_mm=40, sculpts: 2"; what is long, as a mesh's displacements, is counted.
std::string short_parameters(const Json& parameters) {
  std::string text;
  for (const auto& [key, value] : parameters.items()) {
    text += (text.empty() ? "" : ", ") + key;
    text += value.is_structured() ? ": " + std::to_string(value.size()) : "=" + value.dump();
  }
  return text;
}

// Null, with a warning, where the takes cannot be read: the stack itself can be reported all the same.
std::optional<trainer::PoseDatabase> readable_database(const Dataset& dataset) {
  try {
    return trainer::read_pose_database(dataset);
  } catch (const Error& error) {
    say({std::string("how many frames modifiers take is not known: ") + error.what()});
    return std::nullopt;
  }
}

// Null, with a warning, where the selections cannot be read.
std::optional<TakenFrames> readable_frames(const std::optional<trainer::PoseDatabase>& database,
                                           const Modifier& modifier) {
  if (!database || trainer::find_modifier_type(modifier.type) == nullptr) return std::nullopt;
  try {
    return taken_frames(*database, modifier);
  } catch (const Error& error) {
    say({error.what()});
    return std::nullopt;
  }
}

// Frames of like poses whose shapes disagree.

// The worst pair in one pose, and in colour how far apart the shapes are in its region.
std::string draw_pair(const trainer::ShapeStack& stack, const trainer::DisagreeingPair& pair, const std::string& path) {
  const trainer::PairInOnePose shapes = trainer::in_one_pose(stack, pair);
  const double scale = std::max(kFinestScale, pair.most_mm);
  draw_apart(stack.database().character, shapes.first, shapes.second, scale, path);
  return format(
      "wrote {}: {}; the same with what {}, whose pose is {:.1f} degrees off, has in the region {} that poses do not "
      "explain; how far that is, darkest at {:.2f} mm\n",
      path, stack.database().name_of(pair.first), stack.database().name_of(pair.second), pair.pose_degrees, pair.region,
      scale);
}

}  // namespace

TakenFrames taken_frames(const trainer::PoseDatabase& database, const Modifier& modifier) {
  const std::vector<char> selected =
      trainer::selected_frames(database, modifier.frames, "modifier '" + modifier.name + "'");
  TakenFrames result{{}, 0, selected.size()};
  for (std::size_t n = 0; n < selected.size(); ++n) {
    if (!selected[n]) continue;
    const std::string& take = database.take_of(n);
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

std::string text_of(const TakenFrames& frames, const trainer::ModifierType& type, bool enabled) {
  const char* verb = "take";
  if (type.effect == trainer::ModifierType::Effect::drop) verb = "drop";
  if (type.effect == trainer::ModifierType::Effect::weight) verb = "weigh";
  const std::string does = enabled ? std::string(verb) + "s" : std::string("would ") + verb;
  std::string takes;
  for (const auto& [take, count] : frames.by_take) {
    takes += (takes.empty() ? "" : ", ") + take + " " + std::to_string(count);
  }
  return format("{} {} of {} ({})", does, frames.taken, count_of(frames.all, "frame", "frames"), takes);
}

Json frame_json(const trainer::PoseDatabase& database, std::size_t n) {
  return {{"take", database.take_of(n)}, {"frame", database.frames[n].frame}};
}

StackReport report_stack(const Dataset& dataset, const std::optional<trainer::PoseDatabase>& database) {
  StackReport report{bodyopt::to_json(dataset.modifiers), ""};
  if (dataset.modifiers.empty()) return {report.list, "no modifiers: the shapes are read as they are\n"};
  report.text = format("{:>3}  {:20} {:12} {:4} {:>8}  {}\n", "", "modifier", "type", "", "strength", "frames; mask");
  for (std::size_t k = 0; k < dataset.modifiers.size(); ++k) {
    const Modifier& modifier = dataset.modifiers[k];
    const trainer::ModifierType* type = trainer::find_modifier_type(modifier.type);
    report.list[k]["known"] = type != nullptr;
    report.text += format(
        "{:3}  {:20} {:12} {:4} {:8.2f}  {}; {}{}\n", k + 1, modifier.name, modifier.type,
        modifier.enabled ? "on" : "off", modifier.strength, modifier.frames.empty() ? "all" : modifier.frames.dump(),
        modifier.mask.empty() ? "all" : modifier.mask.dump(), type ? "" : "  (of a newer version: not applied)");
    std::string details = short_parameters(modifier.parameters);
    if (const std::optional<TakenFrames> frames = readable_frames(database, modifier)) {
      report.list[k]["frame_counts"] = to_json(*frames);
      details = format("{}{}{}", text_of(*frames, *type, modifier.enabled), details.empty() ? "" : "; ", details);
    }
    if (!details.empty()) report.text += "     " + details + "\n";
  }
  return report;
}

void emit_stack(const CurateArguments& arguments, const Dataset& dataset,
                const std::optional<trainer::PoseDatabase>& database) {
  const StackReport report = report_stack(dataset, database);
  arguments.json.emit({{"dataset", path_of(arguments).string()}, {"modifiers", report.list}}, report.text);
}

void emit_stack(const CurateArguments& arguments) {
  const Dataset dataset = read_dataset(path_of(arguments));
  emit_stack(arguments, dataset, dataset.modifiers.empty() ? std::nullopt : readable_database(dataset));
}

void draw_apart(const Character& character, const Positions& before, const Positions& after, double scale_mm,
                const std::string& path) {
  constexpr std::uint32_t kWidth = 500, kHeight = 700;
  const std::vector<float> first = floats_of(before), second = floats_of(after);
  const report::PosePair drawn{report::flat(character.triangles), first, second};
  draw::Renderer renderer;
  const draw::Camera camera = report::frame_pose(drawn, report::towards_worst(drawn), float{kWidth} / kHeight);
  draw::write_png(report::comparison(renderer, drawn, scale_mm, camera, kWidth, kHeight), path);
}

void report_disagreements(const CurateArguments& arguments) {
  const trainer::ShapeStack stack(trainer::read_pose_database(read_dataset(path_of(arguments))));
  say(stack.notes());
  const trainer::PoseDatabase& database = stack.database();
  const trainer::ConsistencyReport found =
      trainer::report_consistency(stack, arguments.degrees, static_cast<std::size_t>(arguments.worst));
  std::string text;
  if (!found.pairs.empty()) {
    text = format("{:20} {:20} {:24} {:>9} {:>9} {:>9}\n", "frame", "and frame", "region", "apart mm", "most mm",
                  "degrees");
  }
  Json pairs = Json::array(), regions = Json::array();
  for (const trainer::DisagreeingPair& pair : found.pairs) {
    text += format("{:20} {:20} {:24} {:9.2f} {:9.2f} {:9.1f}\n", database.name_of(pair.first),
                   database.name_of(pair.second), pair.region, pair.apart_mm, pair.most_mm, pair.pose_degrees);
    pairs.push_back({{"first", frame_json(database, pair.first)},
                     {"second", frame_json(database, pair.second)},
                     {"region", pair.region},
                     {"apart_mm", pair.apart_mm},
                     {"most_mm", pair.most_mm},
                     {"pose_degrees", pair.pose_degrees}});
  }
  text += format("{}{:24} {:>11} {:>9} {:>10} {:>12}\n", text.empty() ? "" : "\n", "region", "neighbours", "alone",
                 "same pose", "deviation mm");
  for (const trainer::RegionAgreement& region : found.regions) {
    text += format("{:24} {:11.0f} {:8.0f}% {:9.0f}% {:12.3f}\n", region.region, region.neighbours, 100 * region.single,
                   100 * region.same_pose, region.deviation_mm);
    regions.push_back({{"region", region.region},
                       {"neighbours", region.neighbours},
                       {"alone", region.single},
                       {"same_pose", region.same_pose},
                       {"deviation_mm", region.deviation_mm}});
  }
  const auto untold = static_cast<std::size_t>(std::ranges::count_if(
      found.regions, [](const trainer::RegionAgreement& region) { return region.same_pose == 0; }));
  if (untold > 0) {
    text += format(
        "{} no frame in the same pose as one of another motion: too few neighbours to tell whether shapes disagree "
        "there\n",
        count_of(untold, "region has", "regions have"));
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

}  // namespace bodyopt::cli
