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

Kernel::Kernel(const Device& device, std::span<const std::uint32_t> spirv, std::uint32_t written,
               std::uint32_t push_bytes, std::uint32_t frames)
    : binding_count_(count_bindings(spirv)), written_(written) {
  const VkDevice handle = device.handle();
  std::vector<VkDescriptorSetLayoutBinding> bindings(binding_count_);
  for (std::uint32_t b = 0; b < binding_count_; ++b) {
    bindings[b] = {b, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, VK_SHADER_STAGE_COMPUTE_BIT, nullptr};
  }
  set_layout_ = make_set_layout(handle, bindings);
  layout_ = make_pipeline_layout(handle, set_layout_.get(), {VK_SHADER_STAGE_COMPUTE_BIT, 0, push_bytes});
  const ShaderModule shader = make_shader(handle, spirv);

  auto info = structure<VkComputePipelineCreateInfo>(VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO);
  info.stage = shader_stage(VK_SHADER_STAGE_COMPUTE_BIT, shader);
  const VkSpecializationMapEntry constant{0, 0, sizeof(frames)};
  const VkSpecializationInfo constants{1, &constant, sizeof(frames), &frames};
  info.stage.pSpecializationInfo = &constants;
  info.layout = layout_.get();
  VkPipeline pipeline = VK_NULL_HANDLE;
  check(vkCreateComputePipelines(handle, device.pipeline_cache(), 1, &info, nullptr, &pipeline),
        "vkCreateComputePipelines");
  pipeline_ = {handle, pipeline};
}

}  // namespace bodyopt::vulkan
