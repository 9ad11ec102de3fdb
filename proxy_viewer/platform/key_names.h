// Names of keys as commands have them: "Space", "Shift+Left", "F12", "W".
#pragma once

#include <optional>
#include <string>

namespace bodyopt {

// Of GLFW's key event; empty for keys without a name. `printed`: what the user's keyboard layout has on the key
// (glfwGetKeyName), which names letters; keys of digits, and of letters where the layout has a script of its
// own, are called as on a US keyboard.
std::string key_name(int key, const std::string& printed, int modifiers);

// "Left" of "Shift+Left".
std::string bare_key(const std::string& name);

// What Dear ImGui calls a bare key (ImGuiKey); none: it does not want to hear of it.
std::optional<int> imgui_key(const std::string& name);

}  // namespace bodyopt
