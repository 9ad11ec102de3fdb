// The trainer's part of each type of modifier: a file bake_<type>.cpp of this folder, and a line of the table in
// bake_stack.cpp.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "geometry/mesh.h"
#include "runtime/basis/basis.h"

namespace bodyopt {
class JsonObject;
}

namespace bodyopt::trainer {

struct BakeInput {
  const Basis& basis;
  const JsonObject& parameters;         // keys are checked against BakeType::parameters already
  const std::filesystem::path& folder;  // that files are named relative to
  std::string place;                    // "hero.json: modifier 'breath'", for messages
  std::vector<std::string>& notes;      // to be said, a sentence each
};

// The data that a type's drive function of runtime/modifiers expects.
struct BakedModifier {
  std::vector<Positions> components;  // V x 3 each, runtime order, un-posed, metres for a weight of 1
  std::vector<ModifierTurn> turns;
  std::vector<std::uint32_t> joints;
  std::vector<float> numbers;
};

// All throw Error(mismatch) where the character does not suit, Error(file) for files.
BakedModifier bake_breathing(const BakeInput& input);
BakedModifier bake_learnt_breathing(const BakeInput& input);
BakedModifier bake_morph(const BakeInput& input);
BakedModifier bake_sculpt(const BakeInput& input);
BakedModifier bake_flex(const BakeInput& input);
BakedModifier bake_sag(const BakeInput& input);
BakedModifier bake_relax(const BakeInput& input);
BakedModifier bake_push_out(const BakeInput& input);

// An artist's mesh: a PC2 cache of one sample, or a glTF character, with the vertices of the basis' character. V x 3,
// metres. Throws Error(file), and Error(mismatch) for another topology.
Positions read_modifier_shape(const BakeInput& input, const char* key);

// The character's points (O x 3, in the order of its file) in that form; `source` is named where they do not fit.
Positions modifier_shape(const BakeInput& input, const std::vector<float>& points, const std::string& source);

// A number of the parameters, `usual` where it is not named.
double bake_number(const BakeInput& input, const char* key, double usual, double low, double high);

}  // namespace bodyopt::trainer
