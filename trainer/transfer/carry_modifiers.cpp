#include "trainer/transfer/carry_modifiers.h"

#include <nlohmann/json.hpp>

#include "assets/pc2.h"
#include "dataset/modifier.h"
#include "runtime/core/error.h"
#include "runtime/core/transformed.h"
#include "trainer/train/skinning/mesh_table.h"

namespace bodyopt {
namespace {

namespace fs = std::filesystem;

// Gives joints the target's names in every list called "joints", at any depth. False where the target has none of a
// list: that is left as it is, for an empty one would mean all of the skin.
bool rename_joints(Json& json, const TransferPair& pair) {
  bool is_found = true;
  if (json.is_array()) {
    for (Json& item : json) is_found = rename_joints(item, pair) && is_found;
  }
  if (!json.is_object()) return is_found;
  for (auto& [key, value] : json.items()) {
    if (key != "joints" || !value.is_array()) {
      is_found = rename_joints(value, pair) && is_found;
      continue;
    }
    Json names = Json::array();
    for (const Json& name : value) {
      const int joint = name.is_string() ? pair.source.skeleton.find(name.get<std::string>()) : -1;
      const int other = joint < 0 ? -1 : pair.match.target_joint[static_cast<std::size_t>(joint)];
      if (other >= 0) names.push_back(pair.target.skeleton.joints[static_cast<std::size_t>(other)].name);
    }
    if (names.empty() && !value.empty()) {
      is_found = false;
    } else {
      value = names;
    }
  }
  return is_found;
}

class ModifierCarrier {
 public:
  ModifierCarrier(const Dataset& dataset, const Character& source_character, const TransferPair& pair,
                  const fs::path& out, std::vector<std::string>& notes)
      : dataset_(dataset), character_(source_character), pair_(pair), out_(out), notes_(notes) {}

  Modifier carry(Modifier modifier) {
    bool is_carried = modifier.type != "blend";
    for (Json* part : {&modifier.mask, &modifier.frames, &modifier.parameters}) {
      is_carried = rename_joints(*part, pair_) && is_carried;
    }
    for (auto& [key, value] : modifier.parameters.items()) {
      if (key.ends_with("_mm") && value.is_number()) value = pair_.match.size * value.get<double>();
    }
    if (modifier.type == "sculpt" && modifier.parameters.contains("sculpts")) carry_sculpts(modifier.parameters);
    if (!is_carried && modifier.enabled) {
      modifier.enabled = false;
      notes_.push_back("the modifier '" + modifier.name + "' is disabled: what it names is the source's alone");
    }
    return modifier;
  }

 private:
  void carry_sculpts(Json& parameters) {
    for (Json& sculpt : parameters["sculpts"]) {
      const JsonObject object(sculpt, dataset_.folder / "dataset.json", "a sculpt");
      const fs::path name = fs::path("modifiers") / fs::path(object.name("offsets")).filename();
      write_carried(dataset_.folder / object.name("offsets"), out_ / name);
      sculpt["offsets"] = name.string();
    }
  }

  void write_carried(const fs::path& from, const fs::path& to) {
    const Pc2Reader reader(from);
    if (reader.point_count() != character_.output_count() || reader.sample_count() != 1) {
      throw Error(ErrorKind::mismatch, from.string() + ": has " + std::to_string(reader.point_count()) +
                                           " points, and the character " + std::to_string(character_.output_count()) +
                                           ": it was sculpted on another mesh");
    }
    const Positions given = welded_from_output(character_, reader.sample(0).data());
    const Positions carried = pair_.skin(in_order(given, morton_order(character_.vertices)));
    std::vector<float> points;
    for (const std::uint32_t v : pair_.target.mesh.output_vertex) {
      for (int i = 0; i < 3; ++i) points.push_back(static_cast<float>(carried(v, i)));
    }
    fs::create_directories(to.parent_path());
    Pc2Writer writer(to, static_cast<std::uint32_t>(points.size() / 3), 1);
    writer.append(points);
    writer.close();
  }

  const Dataset& dataset_;
  const Character& character_;
  const TransferPair& pair_;
  const fs::path out_;
  std::vector<std::string>& notes_;
};

}  // namespace

std::vector<NamedSelection> carried_selections(const Dataset& dataset, const TransferPair& pair) {
  std::vector<NamedSelection> selections = dataset.selections;
  for (NamedSelection& selection : selections) rename_joints(selection.frames, pair);
  return selections;
}

std::vector<Modifier> carried_modifiers(const Dataset& dataset, const Character& source_character,
                                        const TransferPair& pair, const fs::path& out,
                                        std::vector<std::string>& notes) {
  ModifierCarrier carrier(dataset, source_character, pair, out, notes);
  return transformed(dataset.modifiers, [&](const Modifier& modifier) { return carrier.carry(modifier); });
}

}  // namespace bodyopt
