// A display without a screen (Xvfb), and hands for it (xdotool).
#pragma once

#include <X11/Xlib.h>
#include <X11/Xutil.h>

#include <memory>
#include <string>

#include "draw/renderer.h"
#include "tests/support/background_program.h"
#include "tests/support/run_program.h"
#include "tests/support/temporary_folder.h"

namespace bodyopt::testing {

class XDisplay {
 public:
  // What is missing for it to work here; empty: nothing.
  static std::string missing() {
    for (const char* program : {"Xvfb", "xdotool"}) {
      if (run_program(std::string("command -v ") + program).exit_code != 0)
        return std::string(program) + " is not installed";
    }
    return {};
  }

  XDisplay() : number_(folder_ / "number"), xvfb_(start()) {
    comes_true([this] { return !read_number().empty(); }, 20);
    name_ = ":" + read_number();
    XSetErrorHandler([](Display*, XErrorEvent*) { return 0; });  // a window may go away at any moment
  }

  const std::string& name() const { return name_; }
  // A chain of xdotool's commands.
  ProgramResult hands(const std::string& commands) const {
    return run_program("DISPLAY=" + name_ + " xdotool " + commands);
  }
  // Of the window whose title has these words; empty: there is none.
  std::string window(const std::string& title) const {
    const ProgramResult found = hands("search --onlyvisible --name '" + title + "'");
    return found.exit_code == 0 ? found.output.substr(0, found.output.find('\n')) : "";
  }
  // What the window shows on the screen; no pixels of one that is not there.
  draw::Image picture(const std::string& window) const {
    Display* display = XOpenDisplay(name_.c_str());
    const ::Window id = std::stoul(window);
    XWindowAttributes attributes{};
    XGetWindowAttributes(display, id, &attributes);
    const auto width = static_cast<unsigned>(attributes.width), height = static_cast<unsigned>(attributes.height);
    const bool is_shown = attributes.map_state == IsViewable;
    XImage* screen = is_shown ? XGetImage(display, id, 0, 0, width, height, AllPlanes, ZPixmap) : nullptr;
    draw::Image image{width, height, {}};
    for (int y = 0; screen && y < attributes.height; ++y) {
      for (int x = 0; x < attributes.width; ++x) {
        const unsigned long pixel = XGetPixel(screen, x, y);
        for (const int shift : {16, 8, 0}) image.rgba.push_back(static_cast<std::uint8_t>(pixel >> shift));
        image.rgba.push_back(255);
      }
    }
    if (screen) XDestroyImage(screen);
    XCloseDisplay(display);
    return image;
  }
  // As a window manager does when the cross is clicked.
  void ask_to_close(const std::string& window) const {
    Display* display = XOpenDisplay(name_.c_str());
    XEvent event{};
    event.xclient.type = ClientMessage;
    event.xclient.window = std::stoul(window);
    event.xclient.message_type = XInternAtom(display, "WM_PROTOCOLS", True);
    event.xclient.format = 32;
    event.xclient.data.l[0] = static_cast<long>(XInternAtom(display, "WM_DELETE_WINDOW", True));
    XSendEvent(display, event.xclient.window, False, NoEventMask, &event);
    XCloseDisplay(display);
  }

 private:
  BackgroundProgram* start() {
    // Without -noreset it refuses whoever comes just after the last one left.
    return new BackgroundProgram("Xvfb -displayfd 3 -noreset -screen 0 1000x800x24 -nolisten tcp 3>" + number_.string(),
                                 folder_ / "xvfb.log");
  }
  std::string read_number() const {
    std::ifstream file(number_);
    std::string number;
    return std::getline(file, number) && !file.eof() ? number : "";
  }

  TemporaryFolder folder_;
  std::filesystem::path number_;
  std::unique_ptr<BackgroundProgram> xvfb_;
  std::string name_;
};

}  // namespace bodyopt::testing
