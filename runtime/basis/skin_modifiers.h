// Types of modifiers that move the posed skin, and the form of a stack in a basis file. See SkinModifiers of basis.h.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "shaders/include/layout.h"

namespace bodyopt {

struct SkinModifier;

// A type that moves the posed skin, after all others and after the jiggle, by a kernel of the output stage that runs in
// steps. A stack has at most one of each; they act in its order. The kernel reads their weights alone.
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
// Null for a type that acts before the skin is posed.
const PosedSkinType* posed_skin_type(const std::string& type);

constexpr std::size_t kMostModifiers = 256, kMostModifierComponents = 4096;

// The stack without its tables, as the JSON that a basis file keeps in its metadata. `place` is named by Error(file).
std::string text_of_stack(const std::vector<SkinModifier>& stack, const std::string& place);
std::vector<SkinModifier> stack_from_text(const std::string& text, const std::string& place);

}  // namespace bodyopt
