// An image that shaders sample, with its mipmaps.
#pragma once

#include "draw/graphics_pipeline.h"
#include "draw/png.h"

namespace bodyopt::draw {

// `format`: of bytes that are no sRGB colours, VK_FORMAT_R8G8B8A8_UNORM. Throws Error(device).
Attachment make_texture(const vulkan::Device& device, const Image& image, VkFormat format = kColourFormat);

using Sampler = vulkan::Owned<VkSampler, vkDestroySampler>;

struct Sampling {
  VkSamplerAddressMode u = VK_SAMPLER_ADDRESS_MODE_REPEAT, v = VK_SAMPLER_ADDRESS_MODE_REPEAT;
  bool is_smooth = true;  // between pixels
  auto operator<=>(const Sampling&) const = default;
};
Sampler make_sampler(const vulkan::Device& device, const Sampling& sampling);

}  // namespace bodyopt::draw
