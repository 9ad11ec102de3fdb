// Modifiers of the skin at run time, the last word of an animator on it: breathing, sculpts, morphs. Each
// adds
//   delta d_i += sum_k w_k b_ki      (un-posed space, metres)
// and may turn joints, or moves the skin in the end (PosedSkinType), with weights w_k that a function of its type makes
// of channels over time (runtime/modifiers). Made by the trainer, constant afterwards but for what a shot chooses:
// order, switches, strengths and constants.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "shaders/include/layout.h"

namespace bodyopt {

// A joint that goes with a component: turned about an axis in its parent's bind axes, before its own rotation.
struct ModifierTurn {
  std::uint32_t joint = 0;
  std::uint32_t component = 0;  // of the modifier, from 0 on
  float x = 0, y = 0, z = 0;    // radians per unit of the component's weight
};

struct SkinModifier {
  std::string name;  // of its channels: "breath" is its strength, "breath.rate" a control
  std::string type;  // see skin_modifier_types()
  bool on = true;
  std::map<std::string, float> constants;  // of controls for which a clip has no channel; "strength" among them
  std::uint32_t first_component = 0, component_count = 0;
  std::vector<ModifierTurn> turns;
  std::vector<std::uint32_t> joints;  // what the type says of them
  std::vector<float> numbers;         // what the type says of them
};

struct SkinModifiers {
  std::vector<SkinModifier> stack;         // in the order in which they are applied
  std::vector<std::uint32_t> blend_begin;  // blocks + 1, into blend; empty without modifiers
  std::vector<BlendEntry> blend;           // as of the residual; a component in place of a coefficient

  bool empty() const { return stack.empty(); }
  std::uint32_t component_count() const;
  bool turn_joints() const;
  bool move_posed_skin() const;
  const SkinModifier* of_type(const std::string& type) const;  // the first of a type, or null
};

// A type that moves the posed skin, after all others and after the jiggle, by a kernel of the output stage that runs in
// steps. A stack has at most one of each; they act in its order. Their components move nothing: the kernel reads their
// weights.
enum class PosedSkinStep { relax, separate };
struct PosedSkinType {
  const char* name;
  PosedSkinStep step;
  std::uint32_t steps;
  std::uint32_t components, joint_components;  // of the modifier, and more for each of its joints
  std::uint32_t numbers, joint_numbers;
};
inline constexpr PosedSkinType kRelax = {"relax", PosedSkinStep::relax, kRelaxSteps, 1, 0, 0, 0};
inline constexpr PosedSkinType kPushOut = {"push_out", PosedSkinStep::separate, kSeparateSteps, 0, 3, 1, 7};
inline constexpr const PosedSkinType* kPosedSkinTypes[] = {&kRelax, &kPushOut};
// Null: of a type that acts before the skin is posed.
const PosedSkinType* posed_skin_type(const std::string& type);

constexpr std::size_t kMostModifiers = 256, kMostModifierComponents = 4096;

// The stack without its tables, as the JSON that a basis file keeps in its metadata. `place` is named by Error(file).
std::string text_of_stack(const std::vector<SkinModifier>& stack, const std::string& place);
std::vector<SkinModifier> stack_from_text(const std::string& text, const std::string& place);

}  // namespace bodyopt
