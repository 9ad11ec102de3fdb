// Lets files go over a window, as a file manager does (X drag and drop, version 5).
#pragma once

#include <X11/Xatom.h>
#include <X11/Xlib.h>

#include <algorithm>
#include <chrono>
#include <string>
#include <thread>
#include <vector>

namespace bodyopt::testing {

// The hand that drags: its own connection to the display, and a window that nobody sees.
class FileDrag {
 public:
  explicit FileDrag(const std::string& display) : display_(XOpenDisplay(display.c_str())) {
    own_ = XCreateSimpleWindow(display_, DefaultRootWindow(display_), 0, 0, 1, 1, 0, 0, 0);
  }
  ~FileDrag() { XCloseDisplay(display_); }
  FileDrag(const FileDrag&) = delete;
  FileDrag& operator=(const FileDrag&) = delete;

  // False when the target does not take them in time.
  bool drop(const std::vector<std::string>& files, ::Window target, double seconds) {
    list_.clear();
    for (const std::string& file : files) list_ += "file://" + file + "\r\n";
    XSetSelectionOwner(display_, atom("XdndSelection"), own_, CurrentTime);
    move_over(target);
    send("XdndDrop", {0, 0, CurrentTime, 0, 0});
    const auto start = std::chrono::steady_clock::now();
    while (std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count() < seconds) {
      XEvent event;
      if (XPending(display_) == 0) {
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
        continue;
      }
      XNextEvent(display_, &event);
      if (event.type == SelectionRequest) hand_over(event.xselectionrequest);
      if (event.type == ClientMessage && event.xclient.message_type == atom("XdndFinished")) return true;
    }
    return false;
  }

  // The hand goes over the target, and its window is gone before any answer. It can do nothing more.
  void vanish_over(::Window target) {
    XGrabServer(display_);
    move_over(target);
    XDestroyWindow(display_, own_);
    XUngrabServer(display_);
    XSync(display_, False);
  }

 private:
  void move_over(::Window target) {
    target_ = target;
    send("XdndEnter", {0, 5L << 24, static_cast<long>(atom("text/uri-list")), 0, 0});
    send("XdndPosition", {0, 0, 0, CurrentTime, static_cast<long>(atom("XdndActionCopy"))});
  }

  Atom atom(const char* name) const { return XInternAtom(display_, name, False); }

  // The first number of a message is always the window of the hand.
  void send(const char* message, const std::vector<long>& numbers) const {
    XEvent event{};
    event.xclient.type = ClientMessage;
    event.xclient.window = target_;
    event.xclient.message_type = atom(message);
    event.xclient.format = 32;
    std::copy(numbers.begin(), numbers.end(), event.xclient.data.l);
    event.xclient.data.l[0] = static_cast<long>(own_);
    XSendEvent(display_, target_, False, NoEventMask, &event);
    XFlush(display_);
  }

  void hand_over(const XSelectionRequestEvent& request) const {
    XChangeProperty(display_, request.requestor, request.property, request.target, 8, PropModeReplace,
                    reinterpret_cast<const unsigned char*>(list_.data()), static_cast<int>(list_.size()));
    XEvent event{};
    event.xselection.type = SelectionNotify;
    event.xselection.requestor = request.requestor;
    event.xselection.selection = request.selection;
    event.xselection.target = request.target;
    event.xselection.property = request.property;
    event.xselection.time = request.time;
    XSendEvent(display_, request.requestor, False, NoEventMask, &event);
    XFlush(display_);
  }

  Display* display_;
  ::Window own_, target_ = 0;
  std::string list_;  // text/uri-list
};

}  // namespace bodyopt::testing
