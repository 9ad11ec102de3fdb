#include "assets/clips/shot_modifiers.h"

#include <algorithm>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "assets/clips/controls.h"
#include "base/json_file.h"
#include "base/wording.h"
#include "runtime/core/error.h"
#include "runtime/core/transformed.h"
#include "runtime/modifiers/skin_modifier_type.h"

namespace bodyopt {
namespace {

constexpr double kMostControl = 1e6;

void read_constants(const JsonObject& json, const SkinModifierType& type, SkinModifier& modifier) {
  const Json& controls = json.json().at("controls");
  if (!controls.is_object()) json.refuse("has 'controls' that are no object of numbers by name");
  std::vector<std::string> names;
  for (const SkinModifierControl& control : type.controls) names.emplace_back(control.name);
  for (const auto& [name, value] : controls.items()) {
    if (std::ranges::find(names, name) == names.end()) {
      json.refuse("has the unknown control '", name, "'; '", type.name, "' has ", list_names(names));
    }
    if (!value.is_number() || !(std::abs(value.get<double>()) <= kMostControl)) {
      json.refuse("has the control '", name, "' at ", value.dump(), ", expected a finite number");
    }
    modifier.constants[name] = value.get<float>();
  }
}

std::vector<std::string> names_of(const SkinModifiers& modifiers) {
  return transformed(modifiers.stack, &SkinModifier::name);
}

}  // namespace

bool is_shot_modifier_key(const std::string& key) {
  return key == "name" || key == "on" || key == "strength" || key == "controls";
}

void read_shot_modifier(const JsonObject& json, SkinModifier& modifier) {
  const SkinModifierType* type = find_skin_modifier_type(modifier.type);
  if (type == nullptr) json.refuse("is of the type '", modifier.type, "', which this version does not know");
  if (json.has("on")) modifier.on = json.boolean("on");
  if (json.has("strength")) {
    modifier.constants[kModifierStrength.name] =
        static_cast<float>(json.number("strength", double{kModifierStrength.low}, double{kModifierStrength.high}));
  }
  if (json.has("controls")) read_constants(json, *type, modifier);
}

void choose_modifiers(const std::filesystem::path& path, SkinModifiers& modifiers) {
  const JsonFile top(path, kModifiersSchema, "the file", {"schema", "modifiers"});
  const std::vector<std::string> names = names_of(modifiers);
  std::vector<SkinModifier> chosen, rest = modifiers.stack;
  for (const Json& entry : top.array("modifiers")) {
    const JsonObject object(entry, path, "modifier " + std::to_string(chosen.size() + 1));
    object.allow({"name", "on", "strength", "controls"});
    const std::string name = object.name("name");
    const auto found = std::ranges::find(rest, name, &SkinModifier::name);
    if (found == rest.end()) {
      const bool twice = std::ranges::find(names, name) != names.end();
      throw Error(ErrorKind::mismatch, path, ": the modifier '", name,
                  twice ? "' is named twice" : "' is none of the basis'; it has " + list_names(names));
    }
    chosen.push_back(std::move(*found));
    rest.erase(found);
    read_shot_modifier(object, chosen.back());
  }
  std::ranges::move(rest, std::back_inserter(chosen));
  modifiers.stack = std::move(chosen);
}

void set_channels(const std::vector<std::string>& settings, const std::vector<std::string>& known, Clip& clip) {
  for (const std::string& setting : settings) {
    const std::size_t at = setting.find('=');
    const std::string name = setting.substr(0, at), text = at == std::string::npos ? "" : setting.substr(at + 1);
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    if (name.empty() || text.empty() || *end != '\0' || !(std::abs(value) <= kMostControl)) {
      throw Error(ErrorKind::usage, "a control is set as NAME=VALUE with a finite number, found '", setting, "'");
    }
    if (std::ranges::find(known, name) == known.end()) {
      throw Error(ErrorKind::usage, "the basis has no control '", name, "'; it has ", list_names(known, 40));
    }
    const auto channel = static_cast<std::size_t>(std::ranges::find(clip.controls, name) - clip.controls.begin());
    if (channel == clip.controls.size()) clip.controls.push_back(name);
    for (Pose& pose : clip.poses) {
      pose.controls.resize(clip.controls.size());
      pose.controls[channel] = static_cast<float>(value);
    }
  }
}

std::vector<std::string> apply_channels(const Basis& basis, Clip& clip, ModifierState* state) {
  std::vector<std::string> notes = drive_modifiers(basis, clip.controls, clip.fps, clip.poses, state);
  const std::vector<std::string> used = modifier_channels(basis.modifiers);
  for (const std::string& name : arrange_controls(basis.residual.controls, clip)) {
    if (std::ranges::find(used, name) != used.end()) continue;
    notes.push_back("control '" + name + "' is none that the basis was trained with: it has no effect");
  }
  return notes;
}

}  // namespace bodyopt
