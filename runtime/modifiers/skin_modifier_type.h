// The types of modifiers. Each is a line of the table in skin_modifier_type.cpp; all but constant ones have a file
// drive_<type>.cpp here. The trainer makes their tables of a character in trainer/modifiers/bake_<type>.cpp.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "runtime/basis/basis.h"

namespace bodyopt {

// A channel that a clip may give, by the name "<modifier>.<control>".
struct SkinModifierControl {
  const char* name;
  float usual, low, high;  // values outside are clamped
  const char* what;        // with its unit, one line
};

inline constexpr std::uint32_t kAsBaked = 0;

// A modifier over a clip, or over a part of it.
struct ModifierFrames {
  const Basis& basis;
  const SkinModifier& modifier;
  double frames_per_second;
  std::span<const Pose> poses;               // F, as the modifiers before this one leave them
  std::optional<double>& phase;              // of the frame that comes next; none at the clip's first
  std::vector<std::vector<float>> controls;  // of each of the type's controls, F

  std::size_t count() const { return poses.size(); }
};

struct SkinModifierType {
  const char* name;
  const char* what;  // one line
  std::vector<SkinModifierControl> controls;
  std::uint32_t components;  // that it drives; kAsBaked: as many as were made of the character
  // Fills the weights, F x component_count, for a strength of 1. They depend on the frames and on the phase, which
  // alone goes on from earlier ones. So a part of a shot has the bits of the whole.
  void (*drive)(const ModifierFrames& frames, std::span<float> weights);
};

// Every modifier has this one, whose channel has the modifier's name.
inline constexpr SkinModifierControl kModifierStrength = {"strength", 1, 0, 4, "how much of it is shown"};

std::span<const SkinModifierType> skin_modifier_types();
// Null for a type of a newer version.
const SkinModifierType* find_skin_modifier_type(const std::string& name);

void drive_breathing(const ModifierFrames& frames, std::span<float> weights);
void drive_sculpt(const ModifierFrames& frames, std::span<float> weights);
void drive_flex(const ModifierFrames& frames, std::span<float> weights);
void drive_sag(const ModifierFrames& frames, std::span<float> weights);
void drive_push_out(const ModifierFrames& frames, std::span<float> weights);

}  // namespace bodyopt
