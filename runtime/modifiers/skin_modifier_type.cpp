#include "runtime/modifiers/skin_modifier_type.h"

#include <algorithm>

#include "runtime/basis/skin_modifiers.h"

namespace bodyopt {
namespace {

// Weights of 1: the strength alone says how much is shown.
void drive_constant(const ModifierFrames&, std::span<float> weights) { std::ranges::fill(weights, 1.0f); }

}  // namespace

std::span<const SkinModifierType> skin_modifier_types() {
  static const std::vector<SkinModifierType> types = {
      {"breathing",
       "chest, belly and shoulders move with the breath",
       {{"rate", 14, 0, 60, "breaths a minute"},
        {"depth", 0.6f, 0, 4, "tidal volume, litres on a body 1.75 m tall"},
        {"chest", 0.6f, 0, 1, "what the chest takes of it; the belly takes the rest"},
        {"asymmetry", 1.6f, 0.5f, 4, "how much longer breathing out lasts than breathing in"},
        {"pause", 0.1f, 0, 0.5f, "share of a breath between out and in"},
        {"irregularity", 0.15f, 0, 1, "how much breaths differ in depth and length"},
        {"seed", 0, 0, 1e6f, "which irregular breaths"},
        {"phase", 0, 0, 1, "of the breath at the clip's first frame; 0: about to breathe in"},
        {"hold", 0, 0, 1, "1 holds the breath where it is"},
        {"exertion", 0, 0, 1, "drives all of them from rest to running for life"}},
       kAsBaked,
       drive_breathing},
      {"morph", "a morph target of the character's file, or a mesh, added in un-posed space", {}, 1, drive_constant},
      {"sculpt",
       "an artist's mesh of one pose, shown near that pose",
       {{"always", 0, 0, 1, "1 shows it in every pose"}},
       1,
       drive_sculpt},
      {"flex",
       "muscles that tense and bulge",
       {{"activation", 0, 0, 1, "how hard all of them are tensed; a channel of a muscle's name tenses that one more"}},
       1,
       drive_flex},
      {"sag",
       "soft parts hang as another gravity would have it",
       {{"amount", 1, 0, 4, "gravity, in parts of the earth's"},
        {"forward", 0, -180, 180, "degrees that it is tilted forwards, to +z; -90: the character lies on its back"},
        {"sideways", 0, -180, 180, "degrees that it is tilted to +x"}},
       kAsBaked,
       drive_sag},
      {kRelax.name, "evens out skin that is compressed", {}, 1, drive_constant},
      {kPushOut.name, "keeps skin from crossing itself in folds", {}, kAsBaked, drive_push_out},
  };
  return types;
}

const SkinModifierType* find_skin_modifier_type(const std::string& name) {
  for (const SkinModifierType& type : skin_modifier_types()) {
    if (type.name == name) return &type;
  }
  return nullptr;
}

}  // namespace bodyopt
