#include "runtime/basis/skin_modifiers.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "runtime/basis/basis.h"
#include "runtime/core/error.h"
#include "runtime/core/json.h"
#include "runtime/core/transformed.h"

namespace bodyopt {
namespace {

Json json_of(const SkinModifier& modifier) {
  Json turns = Json::array();
  for (const ModifierTurn& t : modifier.turns) turns.push_back({t.joint, t.component, t.x, t.y, t.z});
  return {{"name", modifier.name},
          {"type", modifier.type},
          {"on", modifier.on},
          {"constants", modifier.constants},
          {"first", modifier.first_component},
          {"components", modifier.component_count},
          {"turns", turns},
          {"joints", modifier.joints},
          {"numbers", modifier.numbers}};
}

ModifierTurn turn_of(const Json& row) {
  return {row.at(0).get<std::uint32_t>(), row.at(1).get<std::uint32_t>(), row.at(2).get<float>(),
          row.at(3).get<float>(), row.at(4).get<float>()};
}

SkinModifier modifier_of(const Json& json) {
  SkinModifier modifier;
  json.at("name").get_to(modifier.name);
  json.at("type").get_to(modifier.type);
  json.at("on").get_to(modifier.on);
  json.at("constants").get_to(modifier.constants);
  json.at("first").get_to(modifier.first_component);
  json.at("components").get_to(modifier.component_count);
  json.at("joints").get_to(modifier.joints);
  json.at("numbers").get_to(modifier.numbers);
  for (const Json& row : json.at("turns")) modifier.turns.push_back(turn_of(row));
  return modifier;
}

}  // namespace

std::uint32_t SkinModifiers::component_count() const {
  std::uint32_t count = 0;
  for (const SkinModifier& modifier : stack) count += modifier.component_count;
  return count;
}

bool SkinModifiers::turn_joints() const {
  return std::ranges::any_of(stack, [](const SkinModifier& modifier) { return !modifier.turns.empty(); });
}

bool SkinModifiers::move_posed_skin() const {
  return std::ranges::any_of(stack, [](const SkinModifier& modifier) { return posed_skin_type(modifier.type); });
}

const PosedSkinType* posed_skin_type(const std::string& type) {
  for (const PosedSkinType* posed : kPosedSkinTypes) {
    if (posed->name == type) return posed;
  }
  return nullptr;
}

const SkinModifier* SkinModifiers::of_type(const std::string& type) const {
  for (const SkinModifier& modifier : stack) {
    if (modifier.type == type) return &modifier;
  }
  return nullptr;
}

std::string text_of_stack(const std::vector<SkinModifier>& stack, const std::string& place) {
  const Json list = transformed(stack, [&](const SkinModifier& modifier) { return json_of(modifier); });
  return strict_json_text(list, place);
}

std::vector<SkinModifier> stack_from_text(const std::string& text, const std::string& place) {
  const auto list = parse_strict_json(text, place);
  std::vector<SkinModifier> stack;
  if (!list.is_array()) throw Error(ErrorKind::file, place, ": is not a list of modifiers; damaged?");
  try {
    for (const Json& json : list) stack.push_back(modifier_of(json));
  } catch (const Json::exception& error) {
    throw Error(ErrorKind::file, place, ": is not a list of modifiers (", error.what(), "); damaged?");
  }
  return stack;
}

}  // namespace bodyopt
