#include "draw/attachment.h"

#include <vector>

#include "runtime/core/transformed.h"

namespace bodyopt {

using vulkan::check;
using vulkan::structure;

namespace {

VkImageAspectFlags aspect_of(VkFormat format) {
  return format == kDepthFormat ? VK_IMAGE_ASPECT_DEPTH_BIT : VK_IMAGE_ASPECT_COLOR_BIT;
}

VkAttachmentDescription description_of(const PassAttachment& image) {
  return {0,
          image.format,
          image.samples,
          image.load,
          image.store,
          VK_ATTACHMENT_LOAD_OP_DONT_CARE,
          VK_ATTACHMENT_STORE_OP_DONT_CARE,
          image.before,
          image.after};
}

}  // namespace

ImageView make_view(const vulkan::Device& device, VkImage image, VkFormat format) {
  auto info = structure<VkImageViewCreateInfo>(VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO);
  info.image = image;
  info.viewType = VK_IMAGE_VIEW_TYPE_2D;
  info.format = format;
  info.subresourceRange = {aspect_of(format), 0, 1, 0, 1};
  VkImageView view = VK_NULL_HANDLE;
  check(vkCreateImageView(device.handle(), &info, nullptr, &view), "vkCreateImageView");
  return {device.handle(), view};
}

Attachment make_attachment(const vulkan::Device& device, const AttachmentInfo& wanted) {
  auto info = structure<VkImageCreateInfo>(VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO);
  info.imageType = VK_IMAGE_TYPE_2D;
  info.format = wanted.image_format == VK_FORMAT_UNDEFINED ? wanted.format : wanted.image_format;
  if (info.format != wanted.format) info.flags = VK_IMAGE_CREATE_MUTABLE_FORMAT_BIT;
  info.extent = {wanted.size.width, wanted.size.height, 1};
  info.mipLevels = 1;
  info.arrayLayers = 1;
  info.samples = wanted.samples;
  info.tiling = VK_IMAGE_TILING_OPTIMAL;
  info.usage = wanted.usage;
  Attachment result;
  VkImage image = VK_NULL_HANDLE;
  check(vkCreateImage(device.handle(), &info, nullptr, &image), "vkCreateImage");
  result.image = {device.handle(), image};

  VkMemoryRequirements needs{};
  vkGetImageMemoryRequirements(device.handle(), image, &needs);
  auto allocation = structure<VkMemoryAllocateInfo>(VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO);
  allocation.allocationSize = needs.size;
  allocation.memoryTypeIndex = device.memory_type(needs.memoryTypeBits, 0, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT);
  VkDeviceMemory memory = VK_NULL_HANDLE;
  check(vkAllocateMemory(device.handle(), &allocation, nullptr, &memory), "vkAllocateMemory for a picture");
  result.memory = {device.handle(), memory};
  check(vkBindImageMemory(device.handle(), image, memory, 0), "vkBindImageMemory");
  result.view = make_view(device, image, wanted.format);
  return result;
}

Framebuffer make_framebuffer(const vulkan::Device& device, VkRenderPass render_pass, VkExtent2D size,
                             std::initializer_list<VkImageView> views) {
  auto info = structure<VkFramebufferCreateInfo>(VK_STRUCTURE_TYPE_FRAMEBUFFER_CREATE_INFO);
  info.renderPass = render_pass;
  info.attachmentCount = static_cast<std::uint32_t>(views.size());
  info.pAttachments = views.begin();
  info.width = size.width;
  info.height = size.height;
  info.layers = 1;
  VkFramebuffer framebuffer = VK_NULL_HANDLE;
  check(vkCreateFramebuffer(device.handle(), &info, nullptr, &framebuffer), "vkCreateFramebuffer");
  return {device.handle(), framebuffer};
}

RenderPass make_render_pass(const vulkan::Device& device, std::span<const PassAttachment> attachments,
                            const VkSubpassDescription& subpass, std::span<const VkSubpassDependency> dependencies) {
  const std::vector<VkAttachmentDescription> descriptions = transformed(attachments, description_of);
  auto info = structure<VkRenderPassCreateInfo>(VK_STRUCTURE_TYPE_RENDER_PASS_CREATE_INFO);
  info.attachmentCount = static_cast<std::uint32_t>(descriptions.size());
  info.pAttachments = descriptions.data();
  info.subpassCount = 1;
  info.pSubpasses = &subpass;
  info.dependencyCount = static_cast<std::uint32_t>(dependencies.size());
  info.pDependencies = dependencies.data();
  VkRenderPass pass = VK_NULL_HANDLE;
  check(vkCreateRenderPass(device.handle(), &info, nullptr, &pass), "vkCreateRenderPass");
  return {device.handle(), pass};
}

RenderPass make_colour_pass(const vulkan::Device& device, const PassAttachment& image,
                            std::span<const VkSubpassDependency> dependencies) {
  const VkAttachmentReference colour{0, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
  VkSubpassDescription subpass{};
  subpass.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS;
  subpass.colorAttachmentCount = 1;
  subpass.pColorAttachments = &colour;
  return make_render_pass(device, {&image, 1}, subpass, dependencies);
}

void pass_on(VkCommandBuffer commands, VkImage image, const ImagePassage& passage) {
  auto barrier = structure<VkImageMemoryBarrier>(VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER);
  barrier.srcAccessMask = passage.after;
  barrier.dstAccessMask = passage.before;
  barrier.oldLayout = passage.from;
  barrier.newLayout = passage.to;
  barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.image = image;
  barrier.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
  vkCmdPipelineBarrier(commands, passage.after_stage, passage.before_stage, 0, 0, nullptr, 0, nullptr, 1, &barrier);
}

}  // namespace bodyopt
