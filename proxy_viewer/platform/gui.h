// Dear ImGui: its context, its look; with a window and a device, or without both (tests, headless pictures). While one
// lives that was made later, it must not be used.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "proxy_viewer/platform/fonts.h"
#include "proxy_viewer/platform/screen.h"
#include "runtime/vulkan/device.h"
#include "runtime/vulkan/object.h"

struct GLFWcursor;
struct GLFWwindow;
struct ImGuiContext;

namespace bodyopt {

class Gui {
 public:
  Gui();
  ~Gui();
  Gui(const Gui&) = delete;
  Gui& operator=(const Gui&) = delete;

  // To be drawn in `pass`; with the clipboard and the cursor of `window`, where there is one. Both must outlive the
  // use.
  void attach(const vulkan::Device& device, VkRenderPass pass, GLFWwindow* window);

  // For the next picture. What goes down and up again before it, is down in it.
  void hear(const WindowEvent& event);

  Fonts& fonts() { return *fonts_; }

  // A picture of panels: begin, panels, end; then record, in the pass. width, height: pixels; `scale`: pixels a point.
  // Panels, and where the mouse is to them, are in points.
  void begin(std::uint32_t width, std::uint32_t height, double seconds, float scale = 1);
  void end();
  // Is there a window whose size was only measured in this picture, as of a menu that was just opened?
  bool hides_window() const;
  void record(VkCommandBuffer commands) const;

 private:
  void start_backend();
  void stop_backend();
  void hear_key(const KeyEvent& event);
  void hear_button(const ButtonEvent& event);
  void let_go();
  void shape_cursor();

  // Of a key or a button since the last picture.
  struct Press {
    bool pressed = false, released = false;

    // `is_down`: in the next picture, which has also what goes up again before it.
    void hear(bool down, bool& is_down) {
      pressed |= down;
      released = !down;
      if (down || !pressed) is_down = down;
    }
  };

  ImGuiContext *before_, *context_;
  std::optional<Fonts> fonts_;              // of the context
  const vulkan::Device* device_ = nullptr;  // none: nothing is drawn
  VkRenderPass pass_ = VK_NULL_HANDLE;
  GLFWwindow* window_ = nullptr;
  std::array<GLFWcursor*, 8> cursors_{};  // of its shapes, made when first shown; GLFW frees them
  std::optional<CursorEvent> cursor_;
  std::array<Press, 32> keys_{};    // by ImGuiKey
  std::array<Press, 5> buttons_{};  // of the mouse
  bool has_backend_ = false;
  vulkan::Owned<VkDescriptorPool, vkDestroyDescriptorPool> pool_;
};

}  // namespace bodyopt
