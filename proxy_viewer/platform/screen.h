// Where pictures are shown and events come from: a window, or what a test puts in its place.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "draw/viewport.h"
#include "proxy_viewer/platform/window_event.h"

struct GLFWwindow;

namespace bodyopt {

class Screen {
 public:
  Screen() = default;
  virtual ~Screen() = default;
  Screen(const Screen&) = delete;
  Screen& operator=(const Screen&) = delete;

  // What has happened since the last call; waits for it at most so long (seconds; 0: not at all).
  virtual std::vector<WindowEvent> poll(double seconds) = 0;
  virtual bool closed() const = 0;
  virtual void set_title(const std::string& title) = 0;
  virtual std::array<std::uint32_t, 2> size() const = 0;  // pixels; 0 while minimised
  // Pixels a point, which panels and their text are measured in: 2 on a display of twice the usual density.
  virtual float scale() const { return 1; }
  // The viewport's picture, also where the size has changed meanwhile.
  virtual void show(const Viewport& viewport) = 0;
  // For the clipboard and the shape of the cursor; null: there are none.
  virtual GLFWwindow* handle() const = 0;
};

}  // namespace bodyopt
