// The window: events, and the picture of the viewport on the screen. GLFW and Vulkan; nothing here knows the scene.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "draw/viewport.h"
#include "runtime/vulkan/device.h"

struct GLFWwindow;

namespace bodyopt {

struct WindowOptions {
  std::string title = "Bodyopt";
  std::uint32_t width = 1280, height = 720;  // pixels
  bool vsync = true;
};

enum class KeyEvent { pressed, repeated, released };

class Window {
 public:
  // Throws Error(device) where there is no display, or no window can be had: it says so and names --headless.
  explicit Window(const WindowOptions& options);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  // What a device must offer to show a picture here.
  vulkan::DeviceUse device_use() const;
  // Before the first show().
  void attach(std::shared_ptr<const vulkan::Device> device);

  // Shows the viewport's picture, also where the surface has changed its size meanwhile.
  void show(const Viewport& viewport);

  // Calls back for what has happened, and says whether anything has; waits for it at most so long (seconds; 0: not at
  // all).
  bool poll(double seconds);
  bool closed() const;
  void set_title(const std::string& title);
  std::array<std::uint32_t, 2> size() const;  // pixels; 0 while minimised
  GLFWwindow* handle() const { return window_; }

  // Before Gui::attach(), which passes on what it hears.
  std::function<void(const std::vector<std::string>& files)> on_drop;
  std::function<void(const std::string& key, KeyEvent event)> on_key;  // see key_names.h

 private:
  struct Swapchain;

  void listen();
  bool show_once(const Viewport& viewport);

  GLFWwindow* window_ = nullptr;
  bool vsync_;
  bool woken_ = false;  // since the last poll()
  std::unique_ptr<Swapchain> swapchain_;
};

}  // namespace bodyopt
