// A graphics pipeline whose shaders pull all they read from storage buffers, by number; and the sets that bind them.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <span>

#include "runtime/vulkan/buffer.h"
#include "runtime/vulkan/commands.h"
#include "runtime/vulkan/make.h"

namespace bodyopt::draw {

// Images that are drawn into.

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
  // The image's own format, where the view has another of the same size; undefined: the same.
  VkFormat image_format = VK_FORMAT_UNDEFINED;
  std::uint32_t levels = 1;  // of mipmaps
};

// Throws Error(device).
Attachment make_attachment(const vulkan::Device& device, const AttachmentInfo& info);
ImageView make_view(const vulkan::Device& device, VkImage image, VkFormat format, std::uint32_t levels = 1);
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

// Both have one subpass; the second draws into one image alone.
RenderPass make_render_pass(const vulkan::Device& device, std::span<const PassAttachment> attachments,
                            const VkSubpassDescription& subpass, std::span<const VkSubpassDependency> dependencies);
RenderPass make_colour_pass(const vulkan::Device& device, const PassAttachment& image,
                            std::span<const VkSubpassDependency> dependencies);

// Begins a pass over all of the framebuffer: what it clears, it clears to black and to the greatest depth.
void begin_pass(VkCommandBuffer commands, VkRenderPass pass, VkFramebuffer framebuffer, VkExtent2D size);

// A change of layout, or no change, between commands that write and commands that read.
struct ImagePassage {
  VkImageLayout from, to;
  VkPipelineStageFlags after_stage, before_stage;
  VkAccessFlags after, before;
  std::uint32_t first_level = 0, level_count = 1;
};
void pass_on(VkCommandBuffer commands, VkImage image, const ImagePassage& passage);

enum class Blending {
  none,
  alpha,    // over what is there, by the alpha of what is drawn
  greatest  // the greater of both
};

struct PipelineInfo {
  std::span<const std::uint32_t> vertex, fragment;  // SPIR-V
  std::uint32_t storage_buffers = 0;                // bindings 0, 1, ...
  std::uint32_t sampled_images = 0;                 // the bindings after those
  std::uint32_t push_bytes = 0;                     // of a block that both stages see
  VkSampleCountFlagBits samples = kSamples;
  Blending blending = Blending::none;
  bool depth_test = true, depth_write = true;
  bool culls_back = false;
  bool covers_by_alpha = false;  // as many samples of a pixel as alpha says; the picture stays opaque
};

class GraphicsPipeline {
 public:
  // Throws Error(device).
  GraphicsPipeline(const vulkan::Device& device, VkRenderPass render_pass, const PipelineInfo& info);

  VkDescriptorSetLayout set_layout() const { return set_layout_.get(); }
  std::uint32_t storage_buffers() const { return storage_buffers_; }

  // Recording. `corners`: three per triangle, from the `first` on; what they are the numbers of, where shaders do not
  // look that up.
  void bind(VkCommandBuffer commands) const;
  template <typename Push>
  void draw(VkCommandBuffer commands, VkDescriptorSet set, const Push& push, std::uint32_t corners,
            const vulkan::Buffer* indices = nullptr, std::uint32_t first = 0) const {
    static_assert(sizeof(Push) <= 128);
    record(commands, set, &push, sizeof(Push), corners, indices, first);
  }

 private:
  void record(VkCommandBuffer commands, VkDescriptorSet set, const void* push, std::uint32_t bytes,
              std::uint32_t corners, const vulkan::Buffer* indices, std::uint32_t first) const;

  std::uint32_t storage_buffers_;
  vulkan::SetLayout set_layout_;
  vulkan::PipelineLayout layout_;
  vulkan::Owned<VkPipeline, vkDestroyPipeline> pipeline_;
};

struct SampledImage {
  VkImageView view = VK_NULL_HANDLE;
  VkSampler sampler = VK_NULL_HANDLE;
};

// The descriptor sets of one picture, however many.
class PictureSets {
 public:
  explicit PictureSets(const vulkan::Device& device) : device_(device), sets_(device) {}
  // Forgets all sets; nothing that uses them may be running.
  void reset() { sets_.reset(); }
  // Throws Error(device) when a buffer is larger than the device lets a shader see.
  VkDescriptorSet make(const GraphicsPipeline& pipeline, std::initializer_list<const vulkan::Buffer*> buffers,
                       std::initializer_list<SampledImage> images = {});

 private:
  const vulkan::Device& device_;
  vulkan::DescriptorSets sets_;
};

}  // namespace bodyopt::draw
