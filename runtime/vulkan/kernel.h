// A compute kernel: its pipeline and the layout of its bindings (storage buffers 0, 1, ... of set 0).
#pragma once

#include <cstdint>
#include <span>

#include "runtime/vulkan/make.h"

namespace bodyopt::vulkan {

class Kernel {
 public:
  // The bindings are those that the shader declares; `written`: a bit for each, of those that it writes, and the others
  // it reads. `frames`: what its constant 0 is, where it has one. Throws Error(device).
  Kernel(const Device& device, std::span<const std::uint32_t> spirv, std::uint32_t written, std::uint32_t push_bytes,
         std::uint32_t frames = 1);

  VkPipeline pipeline() const { return pipeline_.get(); }
  VkPipelineLayout layout() const { return layout_.get(); }
  VkDescriptorSetLayout set_layout() const { return set_layout_.get(); }
  std::uint32_t binding_count() const { return binding_count_; }
  bool writes(std::uint32_t binding) const { return written_ >> binding & 1; }

 private:
  std::uint32_t binding_count_, written_;
  SetLayout set_layout_;
  PipelineLayout layout_;
  Owned<VkPipeline, vkDestroyPipeline> pipeline_;
};

}  // namespace bodyopt::vulkan
