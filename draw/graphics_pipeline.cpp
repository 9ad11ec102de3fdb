#include "draw/graphics_pipeline.h"

#include <array>
#include <vector>

#include "runtime/core/error.h"

namespace bodyopt {

using vulkan::check;
using vulkan::structure;

namespace {

constexpr VkShaderStageFlags kStages = VK_SHADER_STAGE_VERTEX_BIT | VK_SHADER_STAGE_FRAGMENT_BIT;

VkPipelineColorBlendAttachmentState blend_state(Blending blending) {
  VkPipelineColorBlendAttachmentState blend{};
  blend.colorWriteMask =
      VK_COLOR_COMPONENT_R_BIT | VK_COLOR_COMPONENT_G_BIT | VK_COLOR_COMPONENT_B_BIT | VK_COLOR_COMPONENT_A_BIT;
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

}  // namespace

GraphicsPipeline::GraphicsPipeline(const vulkan::Device& device, VkRenderPass render_pass, const PipelineInfo& info)
    : storage_buffers_(info.storage_buffers) {
  make_layout(device.handle(), info);
  make_pipeline(device, render_pass, info);
}

void GraphicsPipeline::make_layout(VkDevice device, const PipelineInfo& wanted) {
  std::vector<VkDescriptorSetLayoutBinding> bindings;
  for (std::uint32_t b = 0; b < wanted.storage_buffers; ++b) {
    bindings.push_back({b, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, kStages, nullptr});
  }
  if (wanted.samples_image) {
    bindings.push_back(
        {wanted.storage_buffers, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1, VK_SHADER_STAGE_FRAGMENT_BIT, nullptr});
  }
  set_layout_ = vulkan::make_set_layout(device, bindings);
  layout_ = vulkan::make_pipeline_layout(device, set_layout_.get(), {kStages, 0, wanted.push_bytes});
}

void GraphicsPipeline::make_pipeline(const vulkan::Device& on_device, VkRenderPass render_pass,
                                     const PipelineInfo& wanted) {
  const VkDevice device = on_device.handle();
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
  auto depth =
      structure<VkPipelineDepthStencilStateCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_DEPTH_STENCIL_STATE_CREATE_INFO);
  depth.depthTestEnable = wanted.depth_test;
  depth.depthWriteEnable = wanted.depth_write;
  depth.depthCompareOp = VK_COMPARE_OP_LESS_OR_EQUAL;
  const VkPipelineColorBlendAttachmentState blend = blend_state(wanted.blending);
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
                              std::uint32_t corners, const vulkan::Buffer* indices) const {
  vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_GRAPHICS, layout_.get(), 0, 1, &set, 0, nullptr);
  vkCmdPushConstants(commands, layout_.get(), kStages, 0, bytes, push);
  if (!indices) {
    vkCmdDraw(commands, corners, 1, 0, 0);
    return;
  }
  vkCmdBindIndexBuffer(commands, indices->handle(), 0, VK_INDEX_TYPE_UINT32);
  vkCmdDrawIndexed(commands, corners, 1, 0, 0, 0);
}

VkDescriptorSet PictureSets::make(const GraphicsPipeline& pipeline,
                                  std::initializer_list<const vulkan::Buffer*> buffers, const SampledImage& image) {
  const VkDescriptorSet set = sets_.allocate(pipeline.set_layout());
  std::vector<VkDescriptorBufferInfo> ranges;
  for (const vulkan::Buffer* buffer : buffers) {
    if (buffer->size() > device_.info().max_storage_buffer_range) {
      throw Error(ErrorKind::device, "a mesh to draw needs a table of " + std::to_string(buffer->size()) +
                                         " bytes; a shader of '" + device_.info().name + "' sees at most " +
                                         std::to_string(device_.info().max_storage_buffer_range));
    }
    ranges.push_back({buffer->handle(), 0, VK_WHOLE_SIZE});
  }
  auto write = structure<VkWriteDescriptorSet>(VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET);
  write.dstSet = set;
  write.descriptorCount = static_cast<std::uint32_t>(ranges.size());
  write.descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
  write.pBufferInfo = ranges.data();
  if (!ranges.empty()) vkUpdateDescriptorSets(device_.handle(), 1, &write, 0, nullptr);
  if (image.view == VK_NULL_HANDLE) return set;
  const VkDescriptorImageInfo sampled{image.sampler, image.view, VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
  write.dstBinding = pipeline.storage_buffers();
  write.descriptorCount = 1;
  write.descriptorType = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
  write.pImageInfo = &sampled;
  vkUpdateDescriptorSets(device_.handle(), 1, &write, 0, nullptr);
  return set;
}

}  // namespace bodyopt
