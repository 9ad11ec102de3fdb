// What is drawn into: four samples a pixel, averaged into one picture that can be copied out.
#pragma once

#include "proxy_viewer/render/renderer.h"
#include "runtime/vulkan/buffer.h"

namespace bodyopt {

constexpr VkFormat kColourFormat = VK_FORMAT_R8G8B8A8_SRGB;
constexpr VkFormat kDepthFormat = VK_FORMAT_D32_SFLOAT;
constexpr VkSampleCountFlagBits kSamples = VK_SAMPLE_COUNT_4_BIT;

using RenderPass = vulkan::Owned<VkRenderPass, vkDestroyRenderPass>;

// Clears, draws, averages the samples, and leaves the picture ready to be copied.
RenderPass make_render_pass(const vulkan::Device& device);

class Target {
 public:
  Target(const vulkan::Device& device, VkRenderPass render_pass, std::uint32_t width, std::uint32_t height);

  // Recording. Between the two, draws go to this target; after end() the picture is on its way to the host.
  void begin(VkCommandBuffer commands) const;
  void end(VkCommandBuffer commands) const;
  // What was drawn, once the commands have run.
  Image picture() const;

 private:
  struct Attachment {
    vulkan::Owned<VkDeviceMemory, vkFreeMemory> memory;
    vulkan::Owned<VkImage, vkDestroyImage> image;
    vulkan::Owned<VkImageView, vkDestroyImageView> view;
  };
  Attachment make_attachment(const vulkan::Device& device, VkFormat format, VkSampleCountFlagBits samples,
                             VkImageUsageFlags usage) const;

  std::uint32_t width_, height_;
  VkRenderPass render_pass_;
  Attachment colour_, depth_, resolved_;
  vulkan::Owned<VkFramebuffer, vkDestroyFramebuffer> framebuffer_;
  vulkan::Buffer readback_;
};

}  // namespace bodyopt
