#include "draw/viewport_images.h"

#include <array>
#include <vector>

#include "draw/viewport.h"

namespace bodyopt {

using vulkan::check;
using vulkan::structure;

namespace {

constexpr VkImageLayout kColourLayout = VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL;
constexpr VkPipelineStageFlags kDrawing = VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT |
                                          VK_PIPELINE_STAGE_EARLY_FRAGMENT_TESTS_BIT |
                                          VK_PIPELINE_STAGE_LATE_FRAGMENT_TESTS_BIT;
constexpr VkAccessFlags kColourAccess = VK_ACCESS_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT;
constexpr VkAccessFlags kDepthAccess =
    VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_READ_BIT | VK_ACCESS_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT;

void begin(VkCommandBuffer commands, VkRenderPass pass, VkFramebuffer framebuffer, VkExtent2D size) {
  std::array<VkClearValue, 3> clear{};
  clear[1].depthStencil.depth = 1;
  auto info = structure<VkRenderPassBeginInfo>(VK_STRUCTURE_TYPE_RENDER_PASS_BEGIN_INFO);
  info.renderPass = pass;
  info.framebuffer = framebuffer;
  info.renderArea = {{0, 0}, size};
  info.clearValueCount = clear.size();
  info.pClearValues = clear.data();
  vkCmdBeginRenderPass(commands, &info, VK_SUBPASS_CONTENTS_INLINE);
}

}  // namespace

RenderPass make_scene_pass(const vulkan::Device& device, VkSampleCountFlagBits samples) {
  const bool resolves = samples != VK_SAMPLE_COUNT_1_BIT;
  std::vector<PassAttachment> attachments = {
      {kColourFormat, VK_SAMPLE_COUNT_1_BIT, resolves ? VK_ATTACHMENT_LOAD_OP_DONT_CARE : VK_ATTACHMENT_LOAD_OP_CLEAR,
       VK_ATTACHMENT_STORE_OP_STORE, VK_IMAGE_LAYOUT_UNDEFINED, kColourLayout},
      {kDepthFormat, samples, VK_ATTACHMENT_LOAD_OP_CLEAR, VK_ATTACHMENT_STORE_OP_DONT_CARE, VK_IMAGE_LAYOUT_UNDEFINED,
       VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL}};
  if (resolves) {
    attachments.push_back({kColourFormat, samples, VK_ATTACHMENT_LOAD_OP_CLEAR, VK_ATTACHMENT_STORE_OP_DONT_CARE,
                           VK_IMAGE_LAYOUT_UNDEFINED, kColourLayout});
  }
  const VkAttachmentReference picture{0, kColourLayout}, several{2, kColourLayout};
  const VkAttachmentReference depth{1, VK_IMAGE_LAYOUT_DEPTH_STENCIL_ATTACHMENT_OPTIMAL};
  VkSubpassDescription subpass{};
  subpass.pipelineBindPoint = VK_PIPELINE_BIND_POINT_GRAPHICS;
  subpass.colorAttachmentCount = 1;
  subpass.pColorAttachments = resolves ? &several : &picture;
  subpass.pResolveAttachments = resolves ? &picture : nullptr;
  subpass.pDepthStencilAttachment = &depth;

  const std::array dependencies = {
      // The picture before may still be on its way out.
      VkSubpassDependency{VK_SUBPASS_EXTERNAL, 0, kDrawing | VK_PIPELINE_STAGE_TRANSFER_BIT, kDrawing,
                          VK_ACCESS_TRANSFER_READ_BIT | kColourAccess | kDepthAccess, kColourAccess | kDepthAccess, 0},
      VkSubpassDependency{0, VK_SUBPASS_EXTERNAL, VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT,
                          VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT, VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT,
                          kColourAccess, 0}};
  return make_render_pass(device, attachments, subpass, dependencies);
}

RenderPass make_panel_pass(const vulkan::Device& device) {
  const std::array dependencies = {
      VkSubpassDependency{VK_SUBPASS_EXTERNAL, 0, VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT,
                          VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT, VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT,
                          kColourAccess, 0},
      VkSubpassDependency{0, VK_SUBPASS_EXTERNAL, VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT,
                          VK_PIPELINE_STAGE_TRANSFER_BIT, VK_ACCESS_COLOR_ATTACHMENT_WRITE_BIT,
                          VK_ACCESS_TRANSFER_READ_BIT, 0}};
  return make_colour_pass(device,
                          {kPictureFormat, VK_SAMPLE_COUNT_1_BIT, VK_ATTACHMENT_LOAD_OP_LOAD,
                           VK_ATTACHMENT_STORE_OP_STORE, kColourLayout, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL},
                          dependencies);
}

ViewportImages::ViewportImages(const vulkan::Device& device, VkRenderPass scene_pass, VkRenderPass panel_pass,
                               VkExtent2D size, VkSampleCountFlagBits samples)
    : size_(size),
      scene_pass_(scene_pass),
      panel_pass_(panel_pass),
      depth_(make_attachment(device,
                             {size, kDepthFormat, samples,
                              VK_IMAGE_USAGE_DEPTH_STENCIL_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSIENT_ATTACHMENT_BIT})),
      picture_(make_attachment(
          device, {size, kColourFormat, VK_SAMPLE_COUNT_1_BIT,
                   VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT, kPictureFormat})),
      bytes_(make_view(device, picture_.image.get(), kPictureFormat)),
      panels_(make_framebuffer(device, panel_pass, size, {bytes_.get()})) {
  if (samples == VK_SAMPLE_COUNT_1_BIT) {
    scene_ = make_framebuffer(device, scene_pass, size, {picture_.view.get(), depth_.view.get()});
    return;
  }
  colour_ = make_attachment(device, {size, kColourFormat, samples,
                                     VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSIENT_ATTACHMENT_BIT});
  scene_ = make_framebuffer(device, scene_pass, size, {picture_.view.get(), depth_.view.get(), colour_.view.get()});
}

void ViewportImages::begin_scene(VkCommandBuffer commands) const { begin(commands, scene_pass_, scene_.get(), size_); }

void ViewportImages::begin_panels(VkCommandBuffer commands) const {
  begin(commands, panel_pass_, panels_.get(), size_);
}

}  // namespace bodyopt
