// The images of the viewport's picture, and the passes that draw into them.
#pragma once

#include "draw/attachment.h"

namespace bodyopt {

// Clears, draws, and averages the samples where there are several; then the panels go on top.
RenderPass make_scene_pass(const vulkan::Device& device, VkSampleCountFlagBits samples);
RenderPass make_panel_pass(const vulkan::Device& device);

class ViewportImages {
 public:
  ViewportImages(const vulkan::Device& device, VkRenderPass scene_pass, VkRenderPass panel_pass, VkExtent2D size,
                 VkSampleCountFlagBits samples);

  void begin_scene(VkCommandBuffer commands) const;
  void begin_panels(VkCommandBuffer commands) const;

  VkExtent2D size() const { return size_; }
  VkImage image() const { return picture_.image.get(); }

 private:
  VkExtent2D size_;
  VkRenderPass scene_pass_, panel_pass_;
  Attachment colour_, depth_;  // of several samples; no colour of one
  Attachment picture_;         // linear colours go in by its view, the panels' bytes by the other
  ImageView bytes_;
  Framebuffer scene_, panels_;
};

}  // namespace bodyopt
