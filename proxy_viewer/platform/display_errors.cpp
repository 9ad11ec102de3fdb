#include "proxy_viewer/platform/display_errors.h"

#include <X11/Xlib.h>

#include <array>
#include <iostream>

namespace bodyopt {
namespace {

// Must not ask the display for anything.
int say(Display* display, XErrorEvent* error) {
  std::array<char, 256> text{};
  XGetErrorText(display, error->error_code, text.data(), static_cast<int>(text.size()));
  std::cerr << "warning: the display refused request " << static_cast<int>(error->request_code) << ": " << text.data()
            << "\n";
  return 0;  // ignored
}

}  // namespace

void survive_display_errors() { XSetErrorHandler(say); }

}  // namespace bodyopt
