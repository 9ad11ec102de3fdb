#include "runtime/vulkan/memory.h"

#include <string>

#include "runtime/vulkan/instance.h"

namespace bodyopt::vulkan {
namespace {

constexpr VkDeviceSize kBlockBytes = VkDeviceSize{4} << 20;

std::shared_ptr<MemoryBlock> allocate(VkDevice device, VkDeviceSize bytes, const MemoryKind& kind, const char* what) {
  const auto require = [&](VkResult result, const char* call) {
    if (result == VK_SUCCESS) return;
    check(result, (std::string(call) + " of " + std::to_string(bytes) + " bytes for " + what).c_str());
  };
  auto block = std::make_shared<MemoryBlock>();
  block->kind = kind;
  block->size = bytes;
  auto info = structure<VkMemoryAllocateInfo>(VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO);
  info.allocationSize = bytes;
  info.memoryTypeIndex = kind.type;
  VkDeviceMemory memory = VK_NULL_HANDLE;
  require(vkAllocateMemory(device, &info, nullptr, &memory), "vkAllocateMemory");
  block->memory = {device, memory};
  if (!kind.mapped) return block;
  void* mapped = nullptr;
  require(vkMapMemory(device, memory, 0, VK_WHOLE_SIZE, 0, &mapped), "vkMapMemory");
  block->mapped = static_cast<std::byte*>(mapped);
  return block;
}

}  // namespace

MemoryPiece MemoryBlocks::take(VkDevice device, const VkMemoryRequirements& needs, const MemoryKind& kind,
                               const char* what) {
  if (needs.size > kBlockBytes / 4) return {allocate(device, needs.size, kind, what), 0};
  const std::lock_guard lock(mutex_);
  std::shared_ptr<MemoryBlock>& block = open_[kind];
  if (block.use_count() == 1) block->used = 0;  // all pieces are given back
  VkDeviceSize offset = block ? (block->used + needs.alignment - 1) / needs.alignment * needs.alignment : 0;
  if (!block || offset + needs.size > block->size) {
    block = allocate(device, kBlockBytes, kind, what);
    offset = 0;
  }
  block->used = offset + needs.size;
  return {block, offset};
}

}  // namespace bodyopt::vulkan
