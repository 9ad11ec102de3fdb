#include "dataset/modifier.h"

#include <algorithm>
#include <set>

#include "assets/json_file.h"
#include "runtime/core/transformed.h"

namespace bodyopt {

const Modifier* find_modifier(const std::vector<Modifier>& modifiers, const std::string& name) {
  const auto found = std::ranges::find(modifiers, name, &Modifier::name);
  return found == modifiers.end() ? nullptr : &*found;
}

Modifier read_modifier(const Json& json, const std::filesystem::path& path, const std::string& place) {
  const JsonObject object(json, path, place);
  Modifier modifier;
  modifier.name = object.name("name");
  modifier.type = object.name("type");
  if (object.has("enabled")) modifier.enabled = object.boolean("enabled");
  if (object.has("strength")) modifier.strength = object.number("strength", 0, 1);
  if (object.has("frames")) modifier.frames = object.array("frames");
  for (const auto& [key, value] : json.items()) {
    if (key == "mask" || key == "parameters") {
      if (!value.is_object()) object.refuse("'", key, "' is not an object");
      (key == "mask" ? modifier.mask : modifier.parameters) = value;
    } else if (key != "name" && key != "type" && key != "enabled" && key != "strength" && key != "frames") {
      modifier.newer[key] = value;
    }
  }
  return modifier;
}

Json to_json(const Modifier& modifier) {
  Json json = {
      {"name", modifier.name}, {"type", modifier.type}, {"enabled", modifier.enabled}, {"strength", modifier.strength}};
  if (!modifier.frames.empty()) json["frames"] = modifier.frames;
  if (!modifier.mask.empty()) json["mask"] = modifier.mask;
  if (!modifier.parameters.empty()) json["parameters"] = modifier.parameters;
  json.update(modifier.newer);
  return json;
}

std::vector<Modifier> read_modifiers(const Json& list, const std::filesystem::path& path) {
  std::vector<Modifier> modifiers;
  std::set<std::string> names;
  for (std::size_t k = 0; k < list.size(); ++k) {
    const std::string place = "modifiers[" + std::to_string(k) + "]";
    modifiers.push_back(read_modifier(list[k], path, place));
    if (!names.insert(modifiers.back().name).second) {
      JsonObject(list[k], path, place).refuse("has the name of an earlier modifier: merged by hand?");
    }
  }
  return modifiers;
}

Json to_json(const std::vector<Modifier>& modifiers) {
  return transformed(modifiers, [&](const Modifier& modifier) { return to_json(modifier); });
}

}  // namespace bodyopt
