// Keymaps for the hands of those who come from other programs.
#include <algorithm>
#include <string>

#include "viewport/commands/commands.h"

namespace bodyopt::viewport {
namespace {

struct ChangedKey {
  const char* command;
  const char* key;  // empty: none
};

constexpr ChangedKey kMayaKeys[] = {{"move-tool", "W"},   {"turn-tool", "E"},  {"wire", "4"},
                                    {"next-style", "6"},  {"heat", "Shift+E"}, {"key", "S"},
                                    {"frame-range", "A"}, {"axes", "Shift+A"}, {"reset-joint", ""}};
constexpr ChangedKey kBlenderKeys[] = {{"move-tool", "G"},
                                       {"turn-tool", "R"},
                                       {"toggle-ghosts", "Shift+G"},
                                       {"reset-joint", "Alt+R"},
                                       {"key", "I"},
                                       {"in", "Ctrl+Home"},
                                       {"out", "Ctrl+End"},
                                       {"first", "Shift+Left"},
                                       {"last", "Shift+Right"},
                                       {"orbit-left", "4"},
                                       {"orbit-right", "6"},
                                       {"frame-range", "Home"},
                                       {"wire", "Shift+Z"},
                                       {"next-style", "Z"},
                                       {"hud", "Alt+Shift+Z"},
                                       {"side-panel", "N"},
                                       {"worst-frame", "Alt+N"}};

std::span<const ChangedKey> changed_keys(Keymap keymap) {
  if (keymap == Keymap::maya) return kMayaKeys;
  return keymap == Keymap::blender ? std::span<const ChangedKey>(kBlenderKeys) : std::span<const ChangedKey>();
}

}  // namespace

const char* key_of(const Command& command, Keymap keymap) {
  const std::span<const ChangedKey> changed = changed_keys(keymap);
  const auto own = std::ranges::find(changed, std::string(command.name), &ChangedKey::command);
  if (own != changed.end()) return own->key;
  const bool is_taken = std::ranges::find(changed, std::string(command.key), &ChangedKey::key) != changed.end();
  return is_taken ? "" : command.key;
}

}  // namespace bodyopt::viewport
