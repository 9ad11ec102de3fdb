#include "runtime/vulkan/kernel.h"

#include <algorithm>
#include <vector>

namespace bodyopt::vulkan {
namespace {

// How many bindings a shader declares, numbered from 0. SPIR-V 1.0, 2.3 and 3.32.3: after a header of five words come
// instructions, each begun by its length (the upper half of a word) and its number.
std::uint32_t count_bindings(std::span<const std::uint32_t> spirv) {
  constexpr std::uint32_t kHeader = 5, kDecorate = 71, kBinding = 33;
  std::uint32_t count = 0;
  for (std::size_t i = kHeader; i < spirv.size(); i += spirv[i] >> 16) {
    if ((spirv[i] & 0xffff) == kDecorate && spirv[i + 2] == kBinding) count = std::max(count, spirv[i + 3] + 1);
  }
  return count;
}

}  // namespace

Kernel::Kernel(const Device& device, std::span<const std::uint32_t> spirv, std::uint32_t push_bytes)
    : binding_count_(count_bindings(spirv)) {
  const VkDevice handle = device.handle();
  std::vector<VkDescriptorSetLayoutBinding> bindings(binding_count_);
  for (std::uint32_t b = 0; b < binding_count_; ++b) {
    bindings[b] = {b, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, VK_SHADER_STAGE_COMPUTE_BIT, nullptr};
  }
  auto set = structure<VkDescriptorSetLayoutCreateInfo>(VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO);
  set.bindingCount = binding_count_;
  set.pBindings = bindings.data();
  VkDescriptorSetLayout set_layout = VK_NULL_HANDLE;
  check(vkCreateDescriptorSetLayout(handle, &set, nullptr, &set_layout), "vkCreateDescriptorSetLayout");
  set_layout_ = {handle, set_layout};

  const VkPushConstantRange push{VK_SHADER_STAGE_COMPUTE_BIT, 0, push_bytes};
  auto layout = structure<VkPipelineLayoutCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO);
  layout.setLayoutCount = 1;
  layout.pSetLayouts = &set_layout;
  layout.pushConstantRangeCount = 1;
  layout.pPushConstantRanges = &push;
  VkPipelineLayout pipeline_layout = VK_NULL_HANDLE;
  check(vkCreatePipelineLayout(handle, &layout, nullptr, &pipeline_layout), "vkCreatePipelineLayout");
  layout_ = {handle, pipeline_layout};

  auto module = structure<VkShaderModuleCreateInfo>(VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO);
  module.codeSize = spirv.size_bytes();
  module.pCode = spirv.data();
  VkShaderModule shader = VK_NULL_HANDLE;
  check(vkCreateShaderModule(handle, &module, nullptr, &shader), "vkCreateShaderModule");
  const Owned<VkShaderModule, vkDestroyShaderModule> owned_shader(handle, shader);

  auto info = structure<VkComputePipelineCreateInfo>(VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO);
  info.stage.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
  info.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
  info.stage.module = shader;
  info.stage.pName = "main";
  info.layout = pipeline_layout;
  VkPipeline pipeline = VK_NULL_HANDLE;
  check(vkCreateComputePipelines(handle, VK_NULL_HANDLE, 1, &info, nullptr, &pipeline), "vkCreateComputePipelines");
  pipeline_ = {handle, pipeline};
}

}  // namespace bodyopt::vulkan
