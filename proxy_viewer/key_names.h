// Names of keys as commands have them: "Space", "Shift+Left", "F12", "W".
#pragma once

#include <string>

namespace bodyopt {

// Of GLFW's key event; empty for keys without a name. Letters and digits are those of the user's keyboard layout.
std::string key_name(int key, int scancode, int modifiers);

}  // namespace bodyopt
