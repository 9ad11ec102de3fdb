#include "draw/texture.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "runtime/vulkan/commands.h"

namespace bodyopt::draw {
namespace {

// Changes the layout of some levels alone.
void change_levels(VkCommandBuffer commands, VkImage image, std::uint32_t first, std::uint32_t count,
                   VkImageLayout from, VkImageLayout to) {
  const bool is_new = from == VK_IMAGE_LAYOUT_UNDEFINED, is_done = to == VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL;
  constexpr VkPipelineStageFlags kCopying = VK_PIPELINE_STAGE_TRANSFER_BIT,
                                 kShading = VK_PIPELINE_STAGE_FRAGMENT_SHADER_BIT;
  constexpr VkAccessFlags kCopies = VK_ACCESS_TRANSFER_READ_BIT | VK_ACCESS_TRANSFER_WRITE_BIT,
                          kReads = VK_ACCESS_SHADER_READ_BIT;
  pass_on(commands, image,
          {from, to, kCopying, is_done ? kShading : kCopying, is_new ? 0 : kCopies, is_done ? kReads : kCopies, first,
           count});
}

}  // namespace

Attachment make_texture(const vulkan::Device& device, const Image& image, VkFormat format) {
  const std::uint32_t levels = static_cast<std::uint32_t>(std::bit_width(std::max(image.width, image.height)));
  const VkImageUsageFlags usage =
      VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT;
  Attachment texture = make_attachment(device, {.size = {image.width, image.height},
                                                .format = format,
                                                .samples = VK_SAMPLE_COUNT_1_BIT,
                                                .usage = usage,
                                                .levels = levels});
  const vulkan::Buffer pixels(device, image.rgba.size(), vulkan::Memory::staging, "an image");
  std::memcpy(pixels.mapped(), image.rgba.data(), image.rgba.size());
  const VkImage whole = texture.image.get();
  constexpr VkImageLayout kFrom = VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, kTo = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL;
  vulkan::Commands commands(device);
  commands.begin();
  change_levels(commands.handle(), whole, 0, levels, VK_IMAGE_LAYOUT_UNDEFINED, kTo);
  VkBufferImageCopy all{};
  all.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
  all.imageExtent = {image.width, image.height, 1};
  vkCmdCopyBufferToImage(commands.handle(), pixels.handle(), whole, kTo, 1, &all);
  const auto side = [](std::uint32_t pixels_of_first, std::uint32_t level) {
    return static_cast<std::int32_t>(std::max(1u, pixels_of_first >> level));
  };
  for (std::uint32_t level = 1; level < levels; ++level) {
    change_levels(commands.handle(), whole, level - 1, 1, kTo, kFrom);
    VkImageBlit halves{};
    halves.srcSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, level - 1, 0, 1};
    halves.srcOffsets[1] = {side(image.width, level - 1), side(image.height, level - 1), 1};
    halves.dstSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, level, 0, 1};
    halves.dstOffsets[1] = {side(image.width, level), side(image.height, level), 1};
    vkCmdBlitImage(commands.handle(), whole, kFrom, whole, kTo, 1, &halves, VK_FILTER_LINEAR);
  }
  constexpr VkImageLayout kRead = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL;
  if (levels > 1) change_levels(commands.handle(), whole, 0, levels - 1, kFrom, kRead);
  change_levels(commands.handle(), whole, levels - 1, 1, kTo, kRead);
  commands.end();
  commands.run();
  return texture;
}

Sampler make_sampler(const vulkan::Device& device, const Sampling& sampling) {
  auto info = vulkan::structure<VkSamplerCreateInfo>(VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO);
  info.magFilter = sampling.is_smooth ? VK_FILTER_LINEAR : VK_FILTER_NEAREST;
  info.minFilter = VK_FILTER_LINEAR;
  info.mipmapMode = VK_SAMPLER_MIPMAP_MODE_LINEAR;
  info.addressModeU = sampling.u;
  info.addressModeV = info.addressModeW = sampling.v;
  info.maxLod = VK_LOD_CLAMP_NONE;
  VkSampler sampler = VK_NULL_HANDLE;
  vulkan::check(vkCreateSampler(device.handle(), &info, nullptr, &sampler), "vkCreateSampler");
  return {device.handle(), sampler};
}

}  // namespace bodyopt::draw
