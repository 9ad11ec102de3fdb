// Dear ImGui: its context, its look; with a window and a device, or without both (tests, headless pictures). While one
// lives that was made later, it must not be used.
#pragma once

#include <imgui.h>

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "draw/png.h"
#include "runtime/vulkan/device.h"
#include "runtime/vulkan/object.h"
#include "viewport/platform/screen.h"

struct GLFWcursor;
struct GLFWwindow;
struct ImGuiContext;

namespace bodyopt::viewport {

// The letters of the panels, from the fonts that are installed here: those that were shown so far. The atlas stays
// small, and the start quick.

class Fonts {
 public:
  Fonts();

  // Sets pixels a point: letters are made anew for another.
  void set_scale(float scale);
  // Adds a text of any script that panels are going to show.
  void show(const std::string& text);
  // Replaces the pictures beside the letters; see add_picture().
  void show_pictures(std::vector<draw::Image> pictures);
  // Loads the letters that are new, between two pictures; false: there are none, and the atlas is as it was.
  bool load_new();
  // Reports once the letters that no font here has.
  std::optional<std::string> take_problem() { return std::exchange(problem_, std::nullopt); }

 private:
  bool open_fonts();
  void copy_pictures(ImFontAtlas& atlas) const;
  bool has_letters_of(const std::string& text) const;

  ImFontGlyphRangesBuilder letters_;
  ImVector<ImWchar> ranges_;            // of the letters: the atlas keeps a pointer
  std::vector<std::string> new_texts_;  // those that have new letters
  std::vector<draw::Image> pictures_;
  bool is_loaded_ = false;
  float scale_ = 1;
  std::optional<std::string> problem_;
};

// Draws the picture of that number of show_pictures(), between two corners.
void add_picture(ImDrawList& list, int number, const ImVec2& from, const ImVec2& to);

// Does a field take what is typed, or will it in the next picture?
bool takes_text();

// A font of digits alone.
ImFont* large_font();

class Gui {
 public:
  Gui();
  ~Gui();
  Gui(const Gui&) = delete;
  Gui& operator=(const Gui&) = delete;

  // Draws in `pass`; takes the clipboard and the cursor of `window`, where there is one. Both outlive it.
  void attach(const vulkan::Device& device, VkRenderPass pass, GLFWwindow* window);

  // Takes an event for the next picture. What goes down and up again before it, is down in it.
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

  // The changes of a key or a button since the last picture.
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

}  // namespace bodyopt::viewport
