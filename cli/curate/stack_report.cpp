#include "cli/curate/stack_report.h"

#include "assets/wording.h"
#include "dataset/modifier.h"
#include "runtime/core/error.h"
#include "trainer/curate/modifier_scope.h"

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

}  // namespace

TakenFrames taken_frames(const PoseDatabase& database, const Modifier& modifier) {
  const std::vector<char> selected = selected_frames(database, modifier.frames, "modifier '" + modifier.name + "'");
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

std::string text_of(const TakenFrames& frames, const ModifierType& type, bool enabled) {
  const char* verb = "take";
  if (type.effect == ModifierType::Effect::drop) verb = "drop";
  if (type.effect == ModifierType::Effect::weight) verb = "weigh";
  const std::string does = enabled ? std::string(verb) + "s" : std::string("would ") + verb;
  std::string takes;
  for (const auto& [take, count] : frames.by_take) {
    takes += (takes.empty() ? "" : ", ") + take + " " + std::to_string(count);
  }
  return format("{} {} of {} ({})", does, frames.taken, count_of(frames.all, "frame", "frames"), takes);
}

Json frame_json(const PoseDatabase& database, std::size_t n) {
  return {{"take", database.take_of(n)}, {"frame", database.frames[n].frame}};
}

StackReport report_stack(const Dataset& dataset, const std::optional<PoseDatabase>& database) {
  StackReport report{bodyopt::to_json(dataset.modifiers), ""};
  if (dataset.modifiers.empty()) return {report.list, "no modifiers: the shapes are read as they are\n"};
  report.text = format("{:>3}  {:20} {:12} {:4} {:>8}  {}\n", "", "modifier", "type", "", "strength", "frames; mask");
  for (std::size_t k = 0; k < dataset.modifiers.size(); ++k) {
    const Modifier& modifier = dataset.modifiers[k];
    const ModifierType* type = find_modifier_type(modifier.type);
    report.list[k]["known"] = type != nullptr;
    report.text += format(
        "{:3}  {:20} {:12} {:4} {:8.2f}  {}; {}{}\n", k + 1, modifier.name, modifier.type,
        modifier.enabled ? "on" : "off", modifier.strength, modifier.frames.empty() ? "all" : modifier.frames.dump(),
        modifier.mask.empty() ? "all" : modifier.mask.dump(), type ? "" : "  (of a newer version: not applied)");
    std::string details = short_parameters(modifier.parameters);
    if (const std::optional<TakenFrames> frames = readable_frames(database, modifier)) {
      report.list[k]["frame_counts"] = to_json(*frames);
      details = text_of(*frames, *type, modifier.enabled) + (details.empty() ? "" : "; ") + details;
    }
    if (!details.empty()) report.text += "     " + details + "\n";
  }
  return report;
}

void emit_stack(const CurateArguments& arguments, const Dataset& dataset, const std::optional<PoseDatabase>& database) {
  const StackReport report = report_stack(dataset, database);
  arguments.json.emit({{"dataset", path_of(arguments).string()}, {"modifiers", report.list}}, report.text);
}

void emit_stack(const CurateArguments& arguments) {
  const Dataset dataset = read_dataset(path_of(arguments));
  emit_stack(arguments, dataset, dataset.modifiers.empty() ? std::nullopt : readable_database(dataset));
}

}  // namespace bodyopt::cli
