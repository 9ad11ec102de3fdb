// Modifiers put on the stack, and changed.
#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/wording.h"
#include "cli/curate/curate_arguments.h"
#include "cli/curate/stack_report.h"
#include "dataset/modifier.h"
#include "runtime/core/error.h"
#include "trainer/curate/edit_stack.h"
#include "trainer/curate/local_models.h"
#include "trainer/curate/modifier_types.h"
#include "trainer/curate/shape_stack.h"

namespace bodyopt::cli {
namespace {

// KEY=VALUE, the value JSON or else text.
Json parameters_of(const std::vector<std::string>& settings) {
  Json parameters = Json::object();
  for (const std::string& setting : settings) {
    const std::size_t equals = setting.find('=');
    if (equals == std::string::npos || equals == 0) {
      throw Error(ErrorKind::usage, "--set takes KEY=VALUE, not '", setting, "'");
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

// Effects of the stack's modifiers on the shapes.

// The frame that a modifier moves most, below it and above.
std::string draw_effect(const trainer::ShapeStack& stack, const trainer::ModifierEffect& effect,
                        const std::string& path) {
  if (effect.frames.empty()) {
    throw Error(ErrorKind::usage, "--picture shows what a modifier moves, and '", effect.name,
                "' moves no vertex of any frame: is it switched off, or of a type that moves none?");
  }
  const std::vector<Modifier>& modifiers = stack.database().dataset.modifiers;
  const auto place = static_cast<std::size_t>(find_modifier(modifiers, effect.name) - modifiers.data());
  const trainer::UnposedSpace::Frame space = stack.space().frame(stack.database().frames[effect.worst].pose);
  const auto left_by = [&](std::size_t count) { return space.shape(stack.offsets(effect.worst, count)); };
  const Positions before = left_by(place), after = left_by(place + 1);
  const double scale = std::max(kFinestScale, 1e3 * (after - before).rowwise().norm().maxCoeff());
  draw_apart(stack.database().character, before, after, scale, path);
  return format("wrote {}: {} before '{}' and after; how far that is, darkest at {:.2f} mm\n", path,
                stack.database().name_of(effect.worst), effect.name, scale);
}

[[noreturn]] void refuse_picture_of_all(const std::vector<Modifier>& modifiers) {
  throw Error(
      ErrorKind::usage,
      "--picture shows what one modifier moves: name it, as in 'curate diff DATASET NAME --picture FILE.png'; the "
      "stack has ",
      list_names(names_of(modifiers)));
}

// A modifier of the type consistency that reaches its cap in many frames hardly takes history alone.
std::vector<std::string> capped_notes(const std::vector<Modifier>& modifiers,
                                      const std::vector<trainer::ModifierEffect>& effects) {
  constexpr std::size_t kMany = 20;  // one frame of so many
  std::vector<std::string> notes;
  for (const trainer::ModifierEffect& effect : effects) {
    const Modifier& modifier = *find_modifier(modifiers, effect.name);
    if (modifier.type != "consistency") continue;
    const double cap = modifier.parameters.value("cap_mm", trainer::kUsualCapMm) * modifier.strength;
    const auto capped = static_cast<std::size_t>(std::ranges::count_if(
        effect.frames, [&](const trainer::FrameEffect& frame) { return frame.max_mm > 0.99 * cap; }));
    if (capped == 0 || capped * kMany < effect.frames.size()) continue;
    notes.push_back(format(
        "'{}' moves {} of {} frames as far as cap_mm lets it ({:.3g} mm): passes seldom disagree by so much; compare "
        "the held-out errors with it and without",
        effect.name, capped, effect.frames.size(), cap));
  }
  return notes;
}

}  // namespace

void add_to_stack(const CurateArguments& arguments) {
  Modifier modifier{.name = arguments.name, .type = arguments.type, .strength = arguments.strength};
  modifier.frames = selections_of(arguments).value_or(Json::array());
  modifier.mask = mask_of(arguments).value_or(Json::object());
  modifier.parameters = parameters_of(arguments.settings);
  const std::optional<trainer::PoseDatabase> database = trainer::add_modifier(path_of(arguments), modifier);
  emit_stack(arguments, database->dataset, database);
}

void edit_stack(const CurateArguments& arguments, bool strength_given) {
  trainer::ModifierChange change;
  if (!arguments.new_name.empty()) change.name = arguments.new_name;
  if (strength_given) change.strength = arguments.strength;
  change.frames = selections_of(arguments);
  change.mask = mask_of(arguments);
  change.parameters = parameters_of(arguments.settings);
  const std::optional<trainer::PoseDatabase> database =
      trainer::change_modifier(path_of(arguments), arguments.name, change);
  emit_stack(arguments, database->dataset, database);
}

void report_effects(const CurateArguments& arguments) {
  const trainer::ShapeStack stack(trainer::read_pose_database(read_dataset(path_of(arguments))));
  say(stack.notes());
  if (!arguments.picture.empty() && arguments.name.empty()) refuse_picture_of_all(stack.database().dataset.modifiers);
  const std::vector<trainer::ModifierEffect> effects = trainer::measure_modifiers(stack, arguments.name);
  std::string text =
      format("{:20} {:>8} {:>10} {:>10}   {}\n", "modifier", "frames", "RMS mm", "max mm", "most of all");
  Json list = Json::array();
  for (const trainer::ModifierEffect& effect : effects) {
    text += format("{:20} {:8} {:10.3f} {:10.3f}   {}\n", effect.name, effect.frames.size(), effect.rms_mm,
                   effect.max_mm, effect.frames.empty() ? "" : stack.database().name_of(effect.worst));
    Json frames = Json::array();
    for (const trainer::FrameEffect& frame : effect.frames) {
      frames.push_back(frame_json(stack.database(), frame.frame));
      frames.back().update({{"rms_mm", frame.rms_mm}, {"max_mm", frame.max_mm}});
    }
    list.push_back({{"name", effect.name}, {"rms_mm", effect.rms_mm}, {"max_mm", effect.max_mm}, {"frames", frames}});
    const Modifier& modifier = *find_modifier(stack.database().dataset.modifiers, effect.name);
    const trainer::ModifierType* type = trainer::find_modifier_type(modifier.type);
    if (type == nullptr || type->effect == trainer::ModifierType::Effect::shape) continue;
    const TakenFrames taken = taken_frames(stack.database(), modifier);
    list.back()["frame_counts"] = to_json(taken);
    text += format("{:20} {}\n", "", text_of(taken, *type, modifier.enabled));
  }
  say(capped_notes(stack.database().dataset.modifiers, effects));
  if (!arguments.picture.empty()) text += draw_effect(stack, effects.front(), arguments.picture);
  arguments.json.emit({{"modifiers", list}}, text);
}

}  // namespace bodyopt::cli
