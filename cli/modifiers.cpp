// bodyopt modifiers: breathing, morphs, sculpts, flexed muscles, sag, relax and push-out for a basis.
#include <nlohmann/json.hpp>
#include <optional>

#include "base/json_file.h"
#include "cli/arguments/common.h"
#include "cli/results/modifier_effects.h"
#include "runtime/basis/levels.h"
#include "runtime/basis/skin_modifiers.h"
#include "runtime/core/transformed.h"
#include "runtime/modifiers/drive_modifiers.h"
#include "trainer/modifiers/bake_stack.h"
#include "trainer/modifiers/measure_modifiers.h"
#include "trainer/motion/joint_limits.h"

namespace bodyopt::cli {
namespace {

struct ModifiersArguments {
  std::string basis, stack, limits, out;
  JsonOption json;
};

// Beside what physiology publishes of an adult of 1.75 m; docs/modifiers.md has the sources.
std::string breath_table(const std::vector<trainer::BreathMeasure>& breaths) {
  const char* const published[] = {"0.4 to 0.6 l, +2 to +5 %, 10 to 40 mm", "2 to 3 l, up to +12 %, 10 to 40 mm"};
  std::string text = format("{:8} {:>7} {:>12} {:>9}   published\n", "breath", "litres", "chest girth", "belly mm");
  for (std::size_t k = 0; k < breaths.size(); ++k) {
    text += format("{:8} {:7.2f} {:+10.1f} % {:9.1f}   {}\n", breaths[k].name, breaths[k].litres,
                   100 * breaths[k].girth_share, breaths[k].belly_mm, published[k]);
  }
  return text;
}

Json json_of_breaths(const std::vector<trainer::BreathMeasure>& breaths) {
  return transformed(breaths, [&](const trainer::BreathMeasure& breath) {
    return Json{{"breath", breath.name},
                {"litres", breath.litres},
                {"girth_share", breath.girth_share},
                {"belly_mm", breath.belly_mm}};
  });
}

void run(const ModifiersArguments& arguments) {
  refuse_overwriting(arguments.out, arguments.basis);
  require_writable(arguments.out);
  arguments.json.require_writable();
  std::vector<Level> levels = load_levels(arguments.basis);
  std::optional<trainer::JointLimits> limits;
  if (!arguments.limits.empty()) limits = trainer::read_joint_limits(arguments.limits, levels.front().basis.skeleton);
  std::vector<std::string> notes;
  for (Level& level : levels) level.basis.modifiers = trainer::bake_stack(arguments.stack, level.basis, notes);
  save_levels(levels, arguments.out);
  say(notes);

  const Basis& basis = levels.front().basis;
  const double bytes = static_cast<double>(table_bytes(basis).at("modify"));
  std::string text = format("{:16} {:12} {:>10}\n", "modifier", "type", "components");
  Json list = Json::array();
  for (const SkinModifier& modifier : basis.modifiers.stack) {
    text += format("{:16} {:12} {:10}\n", modifier.name, modifier.type, modifier.component_count);
    list.push_back({{"name", modifier.name}, {"type", modifier.type}, {"components", modifier.component_count}});
    if (modifier.type == "breathing" && modifier.component_count == 2) {
      const std::vector<trainer::BreathMeasure> breaths = trainer::measure_breathing(basis, modifier);
      text += breath_table(breaths);
      list.back()["breaths"] = json_of_breaths(breaths);
    }
    if (modifier.type == kPushOut.name) {
      const std::vector<trainer::BentJoint> folds =
          limits ? trainer::measure_push_out(basis, *limits) : trainer::measure_push_out(basis);
      text += text_of(folds, limits ? "to its limit, degrees" : "by 130 degrees");
      list.back()["folds"] = to_json(folds);
    }
  }
  text += format("{:.1f} bytes a vertex\nwrote {}\n", bytes / basis.mesh.vertex_count(), arguments.out);
  arguments.json.emit({{"modifiers", list},
                       {"channels", modifier_channels(basis.modifiers)},
                       {"bytes_per_vertex", bytes / basis.mesh.vertex_count()},
                       {"out", arguments.out}},
                      text);
}

}  // namespace

void add_modifiers(CLI::App& app) {
  const auto [verb, arguments] = add_verb<ModifiersArguments>(
      app, "modifiers", "Give a basis modifiers: breathing, morphs, sculpts, flexed muscles, sag, relax, push-out",
      run);
  add_required(verb, "basis", arguments.basis, "BASIS", "Basis (.safetensors)");
  add_required(verb, "stack", arguments.stack, "STACK", "The stack to make (modifiers.json)");
  add_option(verb, "--limits", arguments.limits, "FILE",
             "Joint limits (limits.json): push-out is measured where joints are bent to them, in place of 130 degrees");
  add_option(verb, "--out", arguments.out, "FILE.safetensors",
             "Basis to write, with the modifiers in place of those it had")
      ->required();
  arguments.json.add(verb);
}

}  // namespace bodyopt::cli
