// The window: events, and the picture of the viewport on the screen. GLFW and Vulkan; nothing here knows the scene.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "runtime/vulkan/device.h"
#include "viewport/platform/screen.h"

namespace bodyopt::viewport {

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

  // Returns what a device must offer to show a picture here.
  vulkan::DeviceUse device_use() const;
  // To be called before the first show().
  void attach(std::shared_ptr<const vulkan::Device> device);

  std::vector<WindowEvent> poll(double seconds) override;
  void set_title(const std::string& title) override;
  std::array<std::uint32_t, 2> size() const override;
  float scale() const override;
  void show(const draw::Canvas& canvas) override;
  GLFWwindow* handle() const override { return window_; }

 private:
  struct Swapchain;

  void listen();
  void hear_key(int key, int scancode, int action, int modifiers);
  void hear_cursor(double x, double y);
  bool show_once(const draw::Canvas& canvas);

  GLFWwindow* window_ = nullptr;
  bool vsync_;
  std::vector<WindowEvent> events_;  // since the last poll()
  std::unique_ptr<Swapchain> swapchain_;
};

// Names keys as commands do: "Space", "Shift+Left", "F12", "W". `key`, `modifiers`: GLFW's. `printed`: the keyboard
// layout's own name (glfwGetKeyName), which names letters. Digits, and letters where the layout has a script of its
// own, are named as on a US keyboard. Empty: the key has no name.
std::string key_name(int key, const std::string& printed, int modifiers);

// "Left" of "Shift+Left".
std::string bare_key(const std::string& name);

// Returns Dear ImGui's name of a bare key (ImGuiKey); none: it does not hear of it.
std::optional<int> imgui_key(const std::string& name);

}  // namespace bodyopt::viewport
