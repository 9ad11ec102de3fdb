#include "trainer/modifiers/bake_stack.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "assets/caches/shape_reader.h"
#include "assets/characters/character.h"
#include "assets/clips/clip_source.h"
#include "assets/clips/shot_modifiers.h"
#include "base/json_file.h"
#include "base/wording.h"
#include "geometry/mesh.h"
#include "runtime/basis/character_unit.h"
#include "runtime/basis/skin_modifiers.h"
#include "runtime/core/error.h"
#include "trainer/modifiers/bake_modifier.h"
#include "trainer/train/pack/residual.h"

namespace bodyopt::trainer {
namespace {

constexpr double kNegligible = 1e-6;  // metres

BlockVectors block_of(const Positions& component, Eigen::Index first) {
  const Eigen::Index lanes = std::min<Eigen::Index>(kBlockSize, component.rows() - first);
  BlockVectors vectors = BlockVectors::Zero();
  vectors.leftCols(lanes) = component.middleRows(first, lanes).transpose();
  return vectors;
}

// Fills blend_begin and blend. Each component V x 3, metres. A block takes an entry of 8-bit numbers for each component
// that moves it by more than a micron. Where the first leaves more than that, it takes a second one.
void pack_components(const std::vector<Positions>& components, std::uint32_t vertex_count, SkinModifiers& modifiers) {
  modifiers.blend.clear();
  modifiers.blend_begin = {0};
  for (Eigen::Index first = 0; first < vertex_count; first += kBlockSize) {
    for (std::uint32_t k = 0; k < components.size(); ++k) {
      BlockVectors left = block_of(components[k], first);
      for (int entry = 0; entry < 2 && left.cwiseAbs().maxCoeff() > kNegligible; ++entry) {
        const PackedEntry packed = pack_entry(left, k);
        modifiers.blend.push_back(packed.entry);
        left = packed.left;
      }
    }
    modifiers.blend_begin.push_back(static_cast<std::uint32_t>(modifiers.blend.size()));
  }
}

struct BakeType {
  const char* name;
  std::vector<std::string> parameters;
  BakedModifier (*bake)(const BakeInput& input);
};

const std::vector<BakeType>& bake_types() {
  static const std::vector<BakeType> types = {
      {"breathing", {"dataset", "take"}, bake_breathing},
      {"morph", {"file", "target", "mesh"}, bake_morph},
      {"sculpt", {"mesh", "clip", "up", "frame", "spread_degrees", "joints"}, bake_sculpt},
      {"flex", {"muscles", "muscle", "bulge_mm"}, bake_flex},
      {"sag", {"dynamics"}, bake_sag},
      {kRelax.name, {}, bake_relax},
      {kPushOut.name, {"limit_mm"}, bake_push_out},
  };
  return types;
}

const BakeType& bake_type(const JsonObject& json) {
  const std::string name = json.name("type");
  std::vector<std::string> names;
  for (const BakeType& type : bake_types()) {
    if (type.name == name) return type;
    names.emplace_back(type.name);
  }
  json.refuse("is of the unknown type '", name, "'; there are ", list_names(names));
}

void refuse_unknown_keys(const JsonObject& json, const BakeType& type) {
  for (const auto& [key, value] : json.json().items()) {
    const bool shared = key == "type" || is_shot_modifier_key(key);
    if (shared || std::ranges::find(type.parameters, key) != type.parameters.end()) continue;
    json.refuse("has the unknown key '", key, "': misspelt? '", type.name, "' takes ", list_names(type.parameters));
  }
}

// It has the last word, on skin that is posed: a second one would only go on with it.
void refuse_second(const JsonObject& json, const std::string& type, const SkinModifiers& stack) {
  if (posed_skin_type(type) != nullptr && stack.of_type(type) != nullptr) {
    json.refuse("is the second of the type '", type, "': a stack has one");
  }
}

// A control of the same name that was trained would listen to the same channel.
void refuse_name(const JsonObject& json, const std::string& name, const Basis& basis, std::set<std::string>& known) {
  if (!known.insert(name).second) json.refuse("has the name '", name, "' of another: each needs its own");
  const auto& controls = basis.residual.controls;
  if (std::ranges::find(controls, name) != controls.end()) {
    json.refuse("has the name of the control '", name, "' that the basis was trained with: choose another");
  }
}

}  // namespace

SkinModifiers bake_stack(const std::filesystem::path& path, const Basis& basis, std::vector<std::string>& notes) {
  const Json json = read_json(path, kModifiersSchema);
  const JsonObject top(json, path, "the file");
  top.allow({"schema", "modifiers"});
  SkinModifiers stack;
  std::vector<Positions> components;
  std::set<std::string> known;
  for (const Json& entry : top.array("modifiers")) {
    const JsonObject object(entry, path, "modifier " + std::to_string(stack.stack.size() + 1));
    SkinModifier modifier;
    modifier.name = object.name("name");
    const BakeType& type = bake_type(object);
    modifier.type = type.name;
    refuse_unknown_keys(object, type);
    refuse_second(object, modifier.type, stack);
    refuse_name(object, modifier.name, basis, known);
    read_shot_modifier(object, modifier);
    const std::string place = path.string() + ": modifier '" + modifier.name + "'";
    BakedModifier baked = type.bake({basis, object, path.parent_path(), place, notes});
    modifier.first_component = static_cast<std::uint32_t>(components.size());
    modifier.component_count = static_cast<std::uint32_t>(baked.components.size());
    modifier.turns = std::move(baked.turns);
    modifier.joints = std::move(baked.joints);
    modifier.numbers = std::move(baked.numbers);
    std::ranges::move(baked.components, std::back_inserter(components));
    stack.stack.push_back(std::move(modifier));
  }
  if (stack.stack.empty()) top.refuse("has no modifiers");
  pack_components(components, basis.mesh.vertex_count(), stack);
  return stack;
}

Positions read_modifier_shape(const BakeInput& input, const char* key) {
  const std::filesystem::path path = input.folder / input.parameters.name(key);
  std::vector<float> points;
  if (is_called_scene(path)) {
    const Character character = read_character(path, kept_unit(input.basis));
    points = output_from_welded(character, character.vertices);
  } else {
    const ShapeReader reader(path);
    if (reader.sample_count() != 1) {
      throw Error(ErrorKind::mismatch, input.place, ": ", path, " holds ",
                  count_of(reader.sample_count(), "shape", "shapes"), ", expected 1");
    }
    points = reader.sample(0);
  }
  return modifier_shape(input, points, path.string());
}

Positions modifier_shape(const BakeInput& input, const std::vector<float>& points, const std::string& source) {
  const MeshTable& mesh = input.basis.mesh;
  if (points.size() != 3 * std::size_t{mesh.output_count()}) {
    throw Error(ErrorKind::mismatch, input.place, ": ", source, " has ", points.size() / 3, " points, the character ",
                mesh.output_count(), " vertices: it is of another mesh, or was re-ordered on export");
  }
  Positions shape(mesh.vertex_count(), 3);
  for (std::size_t o = mesh.output_vertex.size(); o-- > 0;) {  // backwards: the first output vertex stays
    for (int i = 0; i < 3; ++i) {
      shape(mesh.output_vertex[o], i) = static_cast<double>(points[3 * o + static_cast<std::size_t>(i)]);
    }
  }
  return shape;
}

double bake_number(const BakeInput& input, const char* key, double usual, double low, double high) {
  return input.parameters.has(key) ? input.parameters.number(key, low, high) : usual;
}

}  // namespace bodyopt::trainer
