// The stack of modifiers that a JSON file asks for, made for a character.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "runtime/basis/basis.h"

namespace bodyopt::trainer {

// Reads a stack (docs/formats.md) and makes its tables for the basis. `notes`: what is to be said, a sentence each.
// Throws Error(file) for bytes, unknown types and keys; Error(mismatch) where the character does not suit.
SkinModifiers bake_stack(const std::filesystem::path& path, const Basis& basis, std::vector<std::string>& notes);

}  // namespace bodyopt::trainer
