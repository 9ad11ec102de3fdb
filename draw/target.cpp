#include "draw/target.h"

#include <array>
#include <cstring>

namespace bodyopt {

using vulkan::check;
using vulkan::structure;

namespace {

constexpr ImagePassage kClearAway{VK_IMAGE_LAYOUT_UNDEFINED,
                                  VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                                  VK_PIPELINE_STAGE_TRANSFER_BIT,
                                  VK_PIPELINE_STAGE_TRANSFER_BIT,
                                  0,
                                  VK_ACCESS_TRANSFER_WRITE_BIT};
constexpr ImagePassage kWriteToRead{VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                                    VK_PIPELINE_STAGE_TRANSFER_BIT,       VK_PIPELINE_STAGE_TRANSFER_BIT,
                                    VK_ACCESS_TRANSFER_WRITE_BIT,         VK_ACCESS_TRANSFER_READ_BIT};

}  // namespace

RenderPass make_target_pass(const vulkan::Device& device) {
  const std::array attachments = {
      PassAttachment{kColourFormat, kSamples, VK_ATTACHMENT_LOAD_OP_CLEAR, VK_ATTACHMENT_STORE_OP_DONT_CARE,
                     VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL}
          .description(),
      PassAttachment{kDepthFormat, kSamples, VK_ATTACHMENT_LOAD_OP_CLEAR, VK_ATTACHMENT_STORE_OP_DONT_CARE,
                     VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL}
          .description(),
      PassAttachment{kColourFormat, VK_SAMPLE_COUNT_1_BIT, VK_ATTACHMENT_LOAD_OP_DONT_CARE,
                     VK_ATTACHMENT_STORE_OP_STORE, VK_IMAGE_LAYOUT_UNDEFINED, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL}
          .description()};
  const VkAttachmentReference colour{0, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
  const VkAttachmentReference depth{1, VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL};
  const VkAttachmentReference resolved{2, VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL};
  VkSubpassDescription subpass{};
  subpass.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS;
  subpass.colorAttachmentCount = 1;
  subpass.pColorAttachments = &colour;
  subpass.pResolveAttachments = &resolved;
  subpass.pDepthStencilAttachment = &depth;

  std::array<VkSubpassDependency, 2> dependencies{};
  const VkPipelineStageFlags drawing = VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT |
                                       VK_PIPELINE_STAGE_EARLY_FRAGMENT_TESTS_BIT |
                                       VK_PIPELINE_STAGE_LATE_FRAGMENT_TESTS_BIT;
  dependencies[0].srcSubpass = VK_SUBPASS_EXTERNAL;
  dependencies[0].srcStageMask = dependencies[0].dstStageMask = drawing;
  dependencies[0].dstAccessMask = VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT | VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_READ_BIT |
                                  VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT;
  dependencies[1].dstSubpass = VK_SUBPASS_EXTERNAL;
  dependencies[1].srcStageMask = VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT;
  dependencies[1].dstStageMask = VK_PIPELINE_STAGE_TRANSFER_BIT;
  dependencies[1].srcAccessMask = VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT;
  dependencies[1].dstAccessMask = VK_ACCESS_TRANSFER_READ_BIT;

  return make_render_pass(device, attachments, subpass, dependencies);
}

Target::Target(const vulkan::Device& device, VkRenderPass render_pass, std::uint32_t width, std::uint32_t height)
    : size_{width, height},
      drawn_{kOversampling * width, kOversampling * height},
      render_pass_(render_pass),
      colour_(make_attachment(device, {drawn_, kColourFormat, kSamples,
                                       VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSIENT_ATTACHMENT_BIT})),
      depth_(make_attachment(device,
                             {drawn_, kDepthFormat, kSamples,
                              VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSIENT_ATTACHMENT_BIT})),
      resolved_(make_attachment(device, {drawn_, kColourFormat, VK_SAMPLE_COUNT_1_BIT,
                                         VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT})),
      shrunk_(make_attachment(device, {size_, kColourFormat, VK_SAMPLE_COUNT_1_BIT,
                                       VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT |
                                           VK_IMAGE_USAGE_TRANSFER_DST_BIT})),
      framebuffer_(
          make_framebuffer(device, render_pass, drawn_, {colour_.view.get(), depth_.view.get(), resolved_.view.get()})),
      readback_(device, VkDeviceSize{width} * height * 4, vulkan::Memory::staging, "the picture") {}

void Target::begin(VkCommandBuffer commands) const {
  std::array<VkClearValue, 2> clear{};
  clear[1].depthStencil.depth = 1;
  const VkRect2D area{{0, 0}, drawn_};
  auto info = structure<VkRenderPassBeginInfo>(VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO);
  info.renderPass = render_pass_;
  info.framebuffer = framebuffer_.get();
  info.renderArea = area;
  info.clearValueCount = clear.size();
  info.pClearValues = clear.data();
  vkCmdBeginRenderPass(commands, &info, VK_SUBPASS_CONTENTS_INLINE);
  const VkViewport viewport{0, 0, static_cast<float>(drawn_.width), static_cast<float>(drawn_.height), 0, 1};
  vkCmdSetViewport(commands, 0, 1, &viewport);
  vkCmdSetScissor(commands, 0, 1, &area);
}

void Target::end(VkCommandBuffer commands) const {
  vkCmdEndRenderPass(commands);
  shrink(commands);
  VkBufferImageCopy region{};
  region.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
  region.imageExtent = {size_.width, size_.height, 1};
  vkCmdCopyImageToBuffer(commands, shrunk_.image.get(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, readback_.handle(), 1,
                         &region);
}

void Target::shrink(VkCommandBuffer commands) const {
  const VkImage from = resolved_.image.get(), to = shrunk_.image.get();
  pass_on(commands, to, kClearAway);
  const auto corner = [](VkExtent2D size) {
    return VkOffset3D{static_cast<std::int32_t>(size.width), static_cast<std::int32_t>(size.height), 1};
  };
  VkImageBlit blit{};
  blit.srcSubresource = blit.dstSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
  blit.srcOffsets[1] = corner(drawn_);
  blit.dstOffsets[1] = corner(size_);
  // Halved, the linear filter is the mean of four pixels.
  vkCmdBlitImage(commands, from, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, to, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1,
                 &blit, VK_FILTER_LINEAR);
  pass_on(commands, to, kWriteToRead);
}

Image Target::picture() const {
  Image image{size_.width, size_.height, std::vector<std::uint8_t>(std::size_t{size_.width} * size_.height * 4)};
  std::memcpy(image.rgba.data(), readback_.mapped(), image.rgba.size());
  return image;
}

}  // namespace bodyopt
