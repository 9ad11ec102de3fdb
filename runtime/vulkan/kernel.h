// A compute kernel: its pipeline and the layout of its bindings (storage buffers 0, 1, ... of set 0).
#pragma once

#include <cstdint>
#include <span>

#include "runtime/vulkan/make.h"

namespace bodyopt::vulkan {

class Kernel {
 public:
  // The bindings are those that the shader declares. Throws Error(device).
  Kernel(const Device& device, std::span<const std::uint32_t> spirv, std::uint32_t push_bytes);

  VkPipeline pipeline() const { return pipeline_.get(); }
  VkPipelineLayout layout() const { return layout_.get(); }
  VkDescriptorSetLayout set_layout() const { return set_layout_.get(); }
  std::uint32_t binding_count() const { return binding_count_; }

 private:
  std::uint32_t binding_count_;
  SetLayout set_layout_;
  PipelineLayout layout_;
  Owned<VkPipeline, vkDestroyPipeline> pipeline_;
};

}  // namespace bodyopt::vulkan
