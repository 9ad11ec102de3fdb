// Descriptor sets from pools that are kept: one pool while the sets are few.
#pragma once

#include <cstddef>
#include <vector>

#include "runtime/vulkan/device.h"
#include "runtime/vulkan/object.h"

namespace bodyopt::vulkan {

class DescriptorSets {
 public:
  explicit DescriptorSets(const Device& device) : device_(device) {}
  // Forgets all sets; nothing that uses them may be running.
  void reset();
  // Of storage buffers, as many as any kernel has, and a sampled image. Throws Error(device).
  VkDescriptorSet allocate(VkDescriptorSetLayout layout);

 private:
  using Pool = Owned<VkDescriptorPool, vkDestroyDescriptorPool>;

  Pool make_pool() const;

  const Device& device_;
  std::vector<Pool> pools_;  // made when those before are used up
  std::size_t made_ = 0;     // sets
};

}  // namespace bodyopt::vulkan
