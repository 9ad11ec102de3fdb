// The screen shows pictures and gives events: a window, or what a test puts in its place.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "draw/canvas.h"

struct GLFWwindow;

namespace bodyopt::viewport {

enum class KeyAction { pressed, repeated, released };

struct KeyEvent {
  std::string name;  // see window.h
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

// Its button is pressed.
struct CloseEvent {};

// It has another size, was uncovered, or is typed into.
struct SurfaceEvent {};

// Events of a window, as values: heard from the display, or played by a test in place of hands.
using WindowEvent = std::variant<KeyEvent, ModifierKeysEvent, LetterEvent, CursorEvent, ButtonEvent, WheelEvent,
                                 DropEvent, CloseEvent, SurfaceEvent>;

class Screen {
 public:
  Screen() = default;
  virtual ~Screen() = default;
  Screen(const Screen&) = delete;
  Screen& operator=(const Screen&) = delete;

  // Returns the events since the last call; waits for them at most so long (seconds; 0: not at all).
  virtual std::vector<WindowEvent> poll(double seconds) = 0;
  virtual void set_title(const std::string& title) = 0;
  virtual std::array<std::uint32_t, 2> size() const = 0;  // pixels; 0 while minimised
  // Pixels a point, which panels and their text are measured in: 2 on a display of twice the usual density.
  virtual float scale() const { return 1; }
  // The viewport's picture, also where the size has changed meanwhile.
  virtual void show(const draw::Canvas& canvas) = 0;
  // Gives the clipboard and the shape of the cursor; null: there are none.
  virtual GLFWwindow* handle() const = 0;
};

}  // namespace bodyopt::viewport
