#include "draw/graphics_pipeline.h"

#include <array>
#include <vector>

#include "runtime/core/error.h"
#include "runtime/core/transformed.h"

namespace bodyopt::draw {

using vulkan::check;
using vulkan::structure;

namespace {

constexpr VkShaderStageFlags kStages = VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT;

VkPipelineColorBlendAttachmentState blend_state(Blending blending, bool covers_by_alpha) {
  VkPipelineColorBlendAttachmentState blend{};
  blend.colorWriteMask = VK_COLOR_COMPONENT_R_BIT | VK_COLOR_COMPONENT_G_BIT | VK_COLOR_COMPONENT_B_BIT;
  if (!covers_by_alpha) blend.colorWriteMask |= VK_COLOR_COMPONENT_A_BIT;
  if (blending == Blending::none) return blend;
  blend.blendEnable = VK_TRUE;
  const bool alpha = blending == Blending::alpha;
  blend.srcColorBlendFactor = alpha ? VK_BLEND_FACTOR_SRC_ALPHA : VK_BLEND_FACTOR_ONE;
  blend.dstColorBlendFactor = alpha ? VK_BLEND_FACTOR_ONE_MINUS_SRC_ALPHA : VK_BLEND_FACTOR_ONE;
  blend.colorBlendOp = alpha ? VK_BLEND_OP_ADD : VK_BLEND_OP_MAX;
  blend.srcAlphaBlendFactor = VK_BLEND_FACTOR_ZERO;  // the picture stays opaque
  blend.dstAlphaBlendFactor = VK_BLEND_FACTOR_ONE;
  blend.alphaBlendOp = VK_BLEND_OP_ADD;
  return blend;
}

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

GraphicsPipeline::GraphicsPipeline(const vulkan::Device& on_device, VkRenderPass render_pass,
                                   const PipelineInfo& wanted)
    : storage_buffers_(wanted.storage_buffers) {
  const VkDevice device = on_device.handle();
  std::vector<VkDescriptorSetLayoutBinding> bindings;
  for (std::uint32_t b = 0; b < wanted.storage_buffers; ++b) {
    bindings.push_back({b, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, kStages, nullptr});
  }
  for (std::uint32_t k = 0; k < wanted.sampled_images; ++k) {
    bindings.push_back({wanted.storage_buffers + k, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1,
                        VK_SHADER_STAGE_FRAGMENT_BIT, nullptr});
  }
  set_layout_ = vulkan::make_set_layout(device, bindings);
  layout_ = vulkan::make_pipeline_layout(device, set_layout_.get(), {kStages, 0, wanted.push_bytes});

  const vulkan::ShaderModule vertex = vulkan::make_shader(device, wanted.vertex);
  const vulkan::ShaderModule fragment = vulkan::make_shader(device, wanted.fragment);
  const std::array stages = {vulkan::shader_stage(VK_SHADER_STAGE_VERTEX_BIT, vertex),
                             vulkan::shader_stage(VK_SHADER_STAGE_FRAGMENT_BIT, fragment)};

  const auto input =
      structure<VkPipelineVertexInputStateCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_VERTEX_INPUT_STATE_CREATE_INFO);
  auto assembly =
      structure<VkPipelineInputAssemblyStateCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_INPUT_ASSEMBLY_STATE_CREATE_INFO);
  assembly.topology = VK_PRIMITIVE_TOPOLOGY_TRIANGLE_LIST;
  auto viewport = structure<VkPipelineViewportStateCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_VIEWPORT_STATE_CREATE_INFO);
  viewport.viewportCount = viewport.scissorCount = 1;
  auto raster =
      structure<VkPipelineRasterizationStateCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_RASTERIZATION_STATE_CREATE_INFO);
  raster.polygonMode = VK_POLYGON_MODE_FILL;
  raster.cullMode = wanted.culls_back ? VK_CULL_MODE_BACK_BIT : VK_CULL_MODE_NONE;
  raster.frontFace = VK_FRONT_FACE_COUNTER_CLOCKWISE;
  raster.lineWidth = 1;
  auto multisample =
      structure<VkPipelineMultisampleStateCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_MULTISAMPLE_STATE_CREATE_INFO);
  multisample.rasterizationSamples = wanted.samples;
  multisample.alphaToCoverageEnable = wanted.covers_by_alpha;
  auto depth =
      structure<VkPipelineDepthStencilStateCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO);
  depth.depthTestEnable = wanted.depth_test;
  depth.depthWriteEnable = wanted.depth_write;
  depth.depthCompareOp = VK_COMPARE_OP_LESS_OR_EQUAL;
  const VkPipelineColorBlendAttachmentState blend = blend_state(wanted.blending, wanted.covers_by_alpha);
  auto blending =
      structure<VkPipelineColorBlendStateCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_COLOR_BLEND_STATE_CREATE_INFO);
  blending.attachmentCount = 1;
  blending.pAttachments = &blend;
  const std::array dynamic_states = {VK_DYNAMIC_STATE_VIEWPORT, VK_DYNAMIC_STATE_SCISSOR};
  auto dynamic = structure<VkPipelineDynamicStateCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_DYNAMIC_STATE_CREATE_INFO);
  dynamic.dynamicStateCount = dynamic_states.size();
  dynamic.pDynamicStates = dynamic_states.data();

  auto info = structure<VkGraphicsPipelineCreateInfo>(VK_STRUCTURE_TYPE_GRAPHICS_PIPELINE_CREATE_INFO);
  info.stageCount = stages.size();
  info.pStages = stages.data();
  info.pVertexInputState = &input;
  info.pInputAssemblyState = &assembly;
  info.pViewportState = &viewport;
  info.pRasterizationState = &raster;
  info.pMultisampleState = &multisample;
  info.pDepthStencilState = &depth;
  info.pColorBlendState = &blending;
  info.pDynamicState = &dynamic;
  info.layout = layout_.get();
  info.renderPass = render_pass;
  VkPipeline pipeline = VK_NULL_HANDLE;
  check(vkCreateGraphicsPipelines(device, on_device.pipeline_cache(), 1, &info, nullptr, &pipeline),
        "vkCreateGraphicsPipelines");
  pipeline_ = {device, pipeline};
}

void GraphicsPipeline::bind(VkCommandBuffer commands) const {
  vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, pipeline_.get());
}

void GraphicsPipeline::record(VkCommandBuffer commands, VkDescriptorSet set, const void* push, std::uint32_t bytes,
                              std::uint32_t corners, const vulkan::Buffer* indices, std::uint32_t first) const {
  vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, layout_.get(), 0, 1, &set, 0, nullptr);
  vkCmdPushConstants(commands, layout_.get(), kStages, 0, bytes, push);
  if (!indices) {
    vkCmdDraw(commands, corners, 1, first, 0);
    return;
  }
  vkCmdBindIndexBuffer(commands, indices->handle(), 0, VK_INDEX_TYPE_UINT32);
  vkCmdDrawIndexed(commands, corners, 1, first, 0, 0);
}

VkDescriptorSet PictureSets::make(const GraphicsPipeline& pipeline,
                                  std::initializer_list<const vulkan::Buffer*> buffers,
                                  std::initializer_list<SampledImage> images) {
  const VkDescriptorSet set = sets_.allocate(pipeline.set_layout());
  std::vector<VkDescriptorBufferInfo> ranges;
  for (const vulkan::Buffer* buffer : buffers) {
    if (buffer->size() > device_.info().max_storage_buffer_range) {
      throw Error(ErrorKind::device, "a mesh to draw needs a table of ", buffer->size(), " bytes; a shader of '",
                  device_.info().name, "' sees at most ", device_.info().max_storage_buffer_range);
    }
    ranges.push_back({buffer->handle(), 0, VK_WHOLE_SIZE});
  }
  auto write = structure<VkWriteDescriptorSet>(VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET);
  write.dstSet = set;
  write.descriptorCount = static_cast<std::uint32_t>(ranges.size());
  write.descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
  write.pBufferInfo = ranges.data();
  if (!ranges.empty()) vkUpdateDescriptorSets(device_.handle(), 1, &write, 0, nullptr);
  write.dstBinding = pipeline.storage_buffers();
  write.descriptorCount = 1;
  write.descriptorType = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
  for (const SampledImage& image : images) {
    const VkDescriptorImageInfo sampled{image.sampler, image.view, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
    write.pImageInfo = &sampled;
    vkUpdateDescriptorSets(device_.handle(), 1, &write, 0, nullptr);
    ++write.dstBinding;
  }
  return set;
}

ImageView make_view(const vulkan::Device& device, VkImage image, VkFormat format, std::uint32_t levels) {
  auto info = structure<VkImageViewCreateInfo>(VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO);
  info.image = image;
  info.viewType = VK_IMAGE_VIEW_TYPE_2D;
  info.format = format;
  info.subresourceRange = {aspect_of(format), 0, levels, 0, 1};
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
  info.mipLevels = wanted.levels;
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
  result.view = make_view(device, image, wanted.format, wanted.levels);
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

void begin_pass(VkCommandBuffer commands, VkRenderPass pass, VkFramebuffer framebuffer, VkExtent2D size) {
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

void pass_on(VkCommandBuffer commands, VkImage image, const ImagePassage& passage) {
  auto barrier = structure<VkImageMemoryBarrier>(VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER);
  barrier.srcAccessMask = passage.after;
  barrier.dstAccessMask = passage.before;
  barrier.oldLayout = passage.from;
  barrier.newLayout = passage.to;
  barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.image = image;
  barrier.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, passage.first_level, passage.level_count, 0, 1};
  vkCmdPipelineBarrier(commands, passage.after_stage, passage.before_stage, 0, 0, nullptr, 0, nullptr, 1, &barrier);
}

}  // namespace bodyopt::draw
