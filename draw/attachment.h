// Images that are drawn into.
#pragma once

#include "runtime/vulkan/buffer.h"

namespace bodyopt {

constexpr VkFormat kColourFormat = VK_FORMAT_R8G8B8A8_SRGB;
constexpr VkFormat kDepthFormat = VK_FORMAT_D32_SFLOAT;
constexpr VkSampleCountFlagBits kSamples = VK_SAMPLE_COUNT_4_BIT;

using RenderPass = vulkan::Owned<VkRenderPass, vkDestroyRenderPass>;
using ImageView = vulkan::Owned<VkImageView, vkDestroyImageView>;
using Framebuffer = vulkan::Owned<VkFramebuffer, vkDestroyFramebuffer>;

struct Attachment {
  vulkan::Owned<VkDeviceMemory, vkFreeMemory> memory;
  vulkan::Owned<VkImage, vkDestroyImage> image;
  ImageView view;
};

struct AttachmentInfo {
  VkExtent2D size;  // pixels
  VkFormat format;
  VkSampleCountFlagBits samples;
  VkImageUsageFlags usage;
  // That of the image, where the view has another of the same size; undefined: the same.
  VkFormat image_format = VK_FORMAT_UNDEFINED;
};

// Throws Error(device).
Attachment make_attachment(const vulkan::Device& device, const AttachmentInfo& info);
ImageView make_view(const vulkan::Device& device, VkImage image, VkFormat format);
Framebuffer make_framebuffer(const vulkan::Device& device, VkRenderPass render_pass, VkExtent2D size,
                             std::initializer_list<VkImageView> views);

// How a render pass takes an image, and leaves it.
struct PassAttachment {
  VkFormat format;
  VkSampleCountFlagBits samples;
  VkAttachmentLoadOp load;
  VkAttachmentStoreOp store;
  VkImageLayout before, after;
};

// Of one subpass; the second draws into one image, and no other.
RenderPass make_render_pass(const vulkan::Device& device, std::span<const PassAttachment> attachments,
                            const VkSubpassDescription& subpass, std::span<const VkSubpassDependency> dependencies);
RenderPass make_colour_pass(const vulkan::Device& device, const PassAttachment& image,
                            std::span<const VkSubpassDependency> dependencies);

// A change of layout, or no change, between commands that write and commands that read.
struct ImagePassage {
  VkImageLayout from, to;
  VkPipelineStageFlags after_stage, before_stage;
  VkAccessFlags after, before;
};
void pass_on(VkCommandBuffer commands, VkImage image, const ImagePassage& passage);

}  // namespace bodyopt
