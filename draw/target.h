// What is drawn into: twice the picture's width and height with four samples each, averaged into a picture that can be
// copied out.
#pragma once

#include "draw/attachment.h"
#include "draw/renderer.h"

namespace bodyopt {

constexpr std::uint32_t kOversampling = 2;  // a side, on top of the samples

// Clears, draws, averages the samples, and leaves the picture ready to be copied.
RenderPass make_target_pass(const vulkan::Device& device);

class Target {
 public:
  Target(const vulkan::Device& device, VkRenderPass render_pass, std::uint32_t width, std::uint32_t height);

  // Recording. Between the two, draws go to this target; after end() the picture is on its way to the host.
  void begin(VkCommandBuffer commands) const;
  void end(VkCommandBuffer commands) const;
  // What was drawn, once the commands have run.
  Image picture() const;

 private:
  void shrink(VkCommandBuffer commands) const;

  VkExtent2D size_, drawn_;  // pixels of the picture, and of what is drawn
  VkRenderPass render_pass_;
  Attachment colour_, depth_, resolved_, shrunk_;
  Framebuffer framebuffer_;
  vulkan::Buffer readback_;
};

}  // namespace bodyopt
