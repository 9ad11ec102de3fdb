// Modifiers put on the stack, and changed.
#include <nlohmann/json.hpp>
#include <optional>

#include "cli/curate/curate_arguments.h"
#include "cli/curate/stack_report.h"
#include "dataset/modifier.h"
#include "runtime/core/error.h"
#include "trainer/curate/edit_stack.h"

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

}  // namespace

void add_to_stack(const CurateArguments& arguments) {
  Modifier modifier{.name = arguments.name, .type = arguments.type, .strength = arguments.strength};
  modifier.frames = selections_of(arguments).value_or(Json::array());
  modifier.mask = mask_of(arguments).value_or(Json::object());
  modifier.parameters = parameters_of(arguments.settings);
  const std::optional<PoseDatabase> database = add_modifier(path_of(arguments), modifier);
  emit_stack(arguments, database->dataset, database);
}

void edit_stack(const CurateArguments& arguments, bool strength_given) {
  ModifierChange change;
  if (!arguments.new_name.empty()) change.name = arguments.new_name;
  if (strength_given) change.strength = arguments.strength;
  change.frames = selections_of(arguments);
  change.mask = mask_of(arguments);
  change.parameters = parameters_of(arguments.settings);
  const std::optional<PoseDatabase> database = change_modifier(path_of(arguments), arguments.name, change);
  emit_stack(arguments, database->dataset, database);
}

}  // namespace bodyopt::cli
