// Makes objects that kernels, pictures and windows need of a device alike. All throw Error(device).
#pragma once

#include <cstdint>
#include <span>

#include "runtime/vulkan/device.h"
#include "runtime/vulkan/object.h"

namespace bodyopt::vulkan {

using CommandPool = Owned<VkCommandPool, vkDestroyCommandPool>;
using Fence = Owned<VkFence, vkDestroyFence>;
using Semaphore = Owned<VkSemaphore, vkDestroySemaphore>;
using PipelineLayout = Owned<VkPipelineLayout, vkDestroyPipelineLayout>;
using SetLayout = Owned<VkDescriptorSetLayout, vkDestroyDescriptorSetLayout>;
using ShaderModule = Owned<VkShaderModule, vkDestroyShaderModule>;

// Makes a pool for a queue of the family, and a command buffer of it, which the pool frees.
CommandPool make_command_pool(const Device& device, std::uint32_t family);
VkCommandBuffer allocate_commands(VkDevice device, VkCommandPool pool);
Fence make_fence(VkDevice device);  // not signalled
Semaphore make_semaphore(VkDevice device);

SetLayout make_set_layout(VkDevice device, std::span<const VkDescriptorSetLayoutBinding> bindings);
// The layout has one set and one block of push constants.
PipelineLayout make_pipeline_layout(VkDevice device, VkDescriptorSetLayout set, const VkPushConstantRange& push);
ShaderModule make_shader(VkDevice device, std::span<const std::uint32_t> spirv);
// `shader` must outlive what is made of the result; its entry point is main.
VkPipelineShaderStageCreateInfo shader_stage(VkShaderStageFlagBits which, const ShaderModule& shader);

}  // namespace bodyopt::vulkan
