// What happens to a window, as values: heard from the display, or played by a test in place of hands.
#pragma once

#include <string>
#include <variant>
#include <vector>

namespace bodyopt {

enum class KeyAction { pressed, repeated, released };

struct KeyEvent {
  std::string name;  // see key_names.h
  KeyAction action = KeyAction::pressed;
};

// Shift and the like, from now on.
struct ModifierKeysEvent {
  bool control = false, shift = false, alt = false;
};

struct LetterEvent {
  char32_t letter;
};

// The mouse, from the left top corner: shares of the window's width and height.
struct CursorEvent {
  double x, y;
};

struct ButtonEvent {
  int button;  // 0: left, 1: right, 2: middle
  bool down;
};

struct WheelEvent {
  double right, up;  // notches
};

struct DropEvent {
  std::vector<std::string> files;
};

// It has another size, was uncovered, or is typed into.
struct SurfaceEvent {};

using WindowEvent = std::variant<KeyEvent, ModifierKeysEvent, LetterEvent, CursorEvent, ButtonEvent, WheelEvent,
                                 DropEvent, SurfaceEvent>;

}  // namespace bodyopt
