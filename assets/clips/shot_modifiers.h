// modifiers.json: what a stack of modifiers is made from, and, with the same keys, what a shot chooses of it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "assets/clips/clip.h"
#include "runtime/basis/basis.h"
#include "runtime/modifiers/drive_modifiers.h"

namespace bodyopt {

class JsonObject;

inline constexpr const char* kModifiersSchema = "bodyopt-modifiers-1";

// "name", "on", "strength" and "controls": what a shot may choose.
bool is_shot_modifier_key(const std::string& key);
// Reads "on", "strength" and "controls" where they are there; "controls" are constants by name. Throws Error(file) for
// controls that the modifier's type does not have.
void read_shot_modifier(const JsonObject& json, SkinModifier& modifier);

// Lets a file choose order, switches, strengths and constants of a stack. Modifiers that it does not name follow those
// that it names, as they are. Throws Error(file); Error(mismatch) for a modifier that the stack does not have.
void choose_modifiers(const std::filesystem::path& path, SkinModifiers& modifiers);

// Gives a clip constant channels, "NAME=VALUE" each, in place of those that it has of that name. Throws Error(usage)
// for other text, and for names that are none of `known`.
void set_channels(const std::vector<std::string>& settings, const std::vector<std::string>& known, Clip& clip);

// The clip as the basis takes it: modifiers applied, then for each pose the controls that the basis was trained with.
// Returns what is to be said: channels without effect, and what was clamped. `state`: as drive_modifiers() takes it.
std::vector<std::string> apply_channels(const Basis& basis, Clip& clip, ModifierState* state = nullptr);

}  // namespace bodyopt
