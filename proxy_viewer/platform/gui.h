// Dear ImGui: its context, its look; with a window and a device, or without both (tests, headless pictures).
#pragma once

#include <cstdint>

#include "proxy_viewer/platform/fonts.h"
#include "runtime/vulkan/device.h"
#include "runtime/vulkan/object.h"

struct GLFWwindow;

namespace bodyopt {

class Gui {
 public:
  Gui();
  ~Gui();
  Gui(const Gui&) = delete;
  Gui& operator=(const Gui&) = delete;

  // To be drawn in `pass`; with the events of `window`, where there is one. The device must outlive the use.
  void attach(const vulkan::Device& device, VkRenderPass pass, GLFWwindow* window);

  Fonts& fonts() { return *fonts_; }

  // A picture of panels: begin, panels, end; then record, in the pass.
  void begin(std::uint32_t width, std::uint32_t height, double seconds);
  void end();
  void record(VkCommandBuffer commands) const;

 private:
  void start_backend();
  void stop_backend();

  std::optional<Fonts> fonts_;              // of the context
  const vulkan::Device* device_ = nullptr;  // none: nothing is drawn
  VkRenderPass pass_ = VK_NULL_HANDLE;
  GLFWwindow* window_ = nullptr;  // none: no events
  bool has_backend_ = false;
  vulkan::Owned<VkDescriptorPool, vkDestroyDescriptorPool> pool_;
};

}  // namespace bodyopt
