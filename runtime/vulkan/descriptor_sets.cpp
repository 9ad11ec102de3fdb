#include "runtime/vulkan/descriptor_sets.h"

#include <array>

namespace bodyopt::vulkan {
namespace {

constexpr std::uint32_t kSetsOfAPool = 256;

}  // namespace

void DescriptorSets::reset() {
  for (const Pool& pool : pools_) {
    check(vkResetDescriptorPool(device_.handle(), pool.get(), 0), "vkResetDescriptorPool");
  }
  made_ = 0;
}

VkDescriptorSet DescriptorSets::allocate(VkDescriptorSetLayout layout) {
  if (made_ == kSetsOfAPool * pools_.size()) pools_.push_back(make_pool());
  auto info = structure<VkDescriptorSetAllocateInfo>(VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO);
  info.descriptorPool = pools_[made_ / kSetsOfAPool].get();
  info.descriptorSetCount = 1;
  info.pSetLayouts = &layout;
  VkDescriptorSet set = VK_NULL_HANDLE;
  check(vkAllocateDescriptorSets(device_.handle(), &info, &set), "vkAllocateDescriptorSets");
  ++made_;
  return set;
}

DescriptorSets::Pool DescriptorSets::make_pool() const {
  const std::array sizes = {
      VkDescriptorPoolSize{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, kSetsOfAPool * BODYOPT_MOST_BINDINGS},
      VkDescriptorPoolSize{VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, kSetsOfAPool}};
  auto info = structure<VkDescriptorPoolCreateInfo>(VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO);
  info.maxSets = kSetsOfAPool;
  info.poolSizeCount = sizes.size();
  info.pPoolSizes = sizes.data();
  VkDescriptorPool pool = VK_NULL_HANDLE;
  check(vkCreateDescriptorPool(device_.handle(), &info, nullptr, &pool), "vkCreateDescriptorPool");
  return {device_.handle(), pool};
}

}  // namespace bodyopt::vulkan
