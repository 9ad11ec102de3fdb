#include "trainer/simulate/materials.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/json_file.h"

namespace bodyopt::trainer {
namespace {

constexpr const char* kSchema = "bodyopt-materials-1";
constexpr double kSoftest = 1e-6, kStiffest = 1e12;  // of any unit here

struct Entry {
  const char* name;
  std::initializer_list<std::pair<const char*, double*>> values;
};

void read_entry(const Json& json, const std::filesystem::path& path, const Entry& entry) {
  const JsonObject object(json, path, std::string("'") + entry.name + "'");
  for (const auto& [key, ignored] : json.items()) {
    const auto known = [&k = key](const auto& value) { return k == value.first; };
    if (key != "source" && std::none_of(entry.values.begin(), entry.values.end(), known)) {
      object.refuse("has the unknown key '" + key + "': misspelt?");
    }
  }
  for (const auto& [key, value] : entry.values) {
    if (object.has(key)) *value = object.number(key, kSoftest, kStiffest);
  }
}

}  // namespace

Materials read_materials(const std::filesystem::path& path) {
  Materials m;
  const Entry entries[] = {
      {"fat", {{"shear_modulus_pa", &m.fat.mu}, {"lame_lambda_pa", &m.fat.lambda}}},
      {"muscle",
       {{"shear_modulus_pa", &m.muscle.mu}, {"lame_lambda_pa", &m.muscle.lambda}, {"bulk_modulus_pa", &m.muscle_bulk}}},
      {"cavity", {{"shear_modulus_pa", &m.cavity.mu}, {"lame_lambda_pa", &m.cavity.lambda}}},
      {"active_fibres", {{"stiffness_pa", &m.active_fibre}, {"slack_stretch", &m.active_slack}}},
      {"passive_fibres", {{"stiffness_pa", &m.passive_fibre}}},
      {"bone_springs", {{"stiffness_n_per_m4", &m.bone_springs}}},
      {"skin", {{"bending_stiffness_n_m", &m.skin_bending}}},
      {"contact", {{"stiffness_pa_per_m", &m.contact}}},
  };
  const Json json = read_json(path, kSchema);
  const JsonObject top(json, path, "the file");
  top.allow(
      {"schema", "fat", "muscle", "cavity", "active_fibres", "passive_fibres", "bone_springs", "skin", "contact"});
  for (const Entry& entry : entries) {
    if (top.has(entry.name)) read_entry(json[entry.name], path, entry);
  }
  if (!(m.active_slack < 1)) top.refuse("gives fibres a slack_stretch of 1 or more: they could not pull at rest");
  return m;
}

}  // namespace bodyopt::trainer
