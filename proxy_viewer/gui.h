// Dear ImGui: its context, its look, its fonts; with a window and a device, or without both (tests, headless pictures).
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "runtime/vulkan/device.h"
#include "runtime/vulkan/object.h"

struct GLFWwindow;
struct ImFont;

namespace bodyopt {

class Gui {
 public:
  // `texts`: names that are to be shown in their own script (files, joints). What has no font here is said in
  // problem().
  explicit Gui(const std::vector<std::string>& texts);
  ~Gui();
  Gui(const Gui&) = delete;
  Gui& operator=(const Gui&) = delete;

  const std::optional<std::string>& problem() const { return problem_; }

  // To be drawn in `pass`; with the events of `window`, where there is one. The device must outlive the use.
  void attach(const vulkan::Device& device, VkRenderPass pass, GLFWwindow* window);

  // A picture of panels: begin, panels, end; then record, in the pass.
  void begin(std::uint32_t width, std::uint32_t height, double seconds);
  void end();
  void record(VkCommandBuffer commands) const;

 private:
  void load_fonts(const std::vector<std::string>& texts);

  std::optional<std::string> problem_;
  bool has_device_ = false, has_window_ = false;
  vulkan::Owned<VkDescriptorPool, vkDestroyDescriptorPool> pool_;
};

// Of digits alone.
ImFont* large_font();

}  // namespace bodyopt
