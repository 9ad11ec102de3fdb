// The window: events, and the picture of the viewport on the screen. GLFW and Vulkan; nothing here knows the scene.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "proxy_viewer/platform/screen.h"
#include "runtime/vulkan/device.h"

namespace bodyopt {

struct WindowOptions {
  std::string title = "Bodyopt";
  std::uint32_t width = 1280, height = 720;  // pixels
  bool vsync = true;
};

class Window : public Screen {
 public:
  // Throws Error(device) where there is no display, or no window can be had: it says so and names --headless.
  explicit Window(const WindowOptions& options);
  ~Window() override;

  // What a device must offer to show a picture here.
  vulkan::DeviceUse device_use() const;
  // Before the first show().
  void attach(std::shared_ptr<const vulkan::Device> device);

  std::vector<WindowEvent> poll(double seconds) override;
  void set_title(const std::string& title) override;
  std::array<std::uint32_t, 2> size() const override;
  float scale() const override;
  void show(const Viewport& viewport) override;
  GLFWwindow* handle() const override { return window_; }

 private:
  struct Swapchain;

  void listen();
  void hear_key(int key, int scancode, int action, int modifiers);
  void hear_cursor(double x, double y);
  bool show_once(const Viewport& viewport);

  GLFWwindow* window_ = nullptr;
  bool vsync_;
  std::vector<WindowEvent> events_;  // since the last poll()
  std::unique_ptr<Swapchain> swapchain_;
};

// Names of keys as commands have them: "Space", "Shift+Left", "F12", "W".
// Of GLFW's key event; empty for keys without a name. `printed`: what the user's keyboard layout has on the key
// (glfwGetKeyName), which names letters; keys of digits, and of letters where the layout has a script of its
// own, are called as on a US keyboard.
std::string key_name(int key, const std::string& printed, int modifiers);

// "Left" of "Shift+Left".
std::string bare_key(const std::string& name);

// What Dear ImGui calls a bare key (ImGuiKey); none: it does not want to hear of it.
std::optional<int> imgui_key(const std::string& name);

}  // namespace bodyopt
