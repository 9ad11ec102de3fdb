// The keymap that the user chose, in a folder of theirs.
#pragma once

#include <filesystem>

#include "viewport/commands/controls.h"

namespace bodyopt::viewport {

// An empty folder: none is kept. Throw Error(file).
Keymap read_keymap(const std::filesystem::path& folder);
void write_keymap(Keymap keymap, const std::filesystem::path& folder);

}  // namespace bodyopt::viewport
