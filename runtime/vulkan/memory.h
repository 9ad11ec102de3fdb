// Memory for buffers, many of them in one allocation: drivers allow few (4,096 is usual) and take long for each.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>

#include "runtime/vulkan/object.h"

namespace bodyopt::vulkan {

struct MemoryKind {
  std::uint32_t type = 0;  // of the device
  bool mapped = false;     // for as long as it lives
  auto operator<=>(const MemoryKind&) const = default;
};

// One allocation. It lives as long as a piece of it.
struct MemoryBlock {
  MemoryKind kind;
  VkDeviceSize size = 0, used = 0;
  Owned<VkDeviceMemory, vkFreeMemory> memory;
  std::byte* mapped = nullptr;
};

struct MemoryPiece {
  std::shared_ptr<const MemoryBlock> block;
  VkDeviceSize offset = 0;
};

// Pieces are cut from a block one after the other; what is given back is free again when all of its block is. A piece
// that is much of a block gets one of its own. One block of each kind is kept.
class MemoryBlocks {
 public:
  // Throws Error(device) that names `what` it is for. From any thread.
  MemoryPiece take(VkDevice device, const VkMemoryRequirements& needs, const MemoryKind& kind, const char* what);

 private:
  std::mutex mutex_;
  std::map<MemoryKind, std::shared_ptr<MemoryBlock>> open_;  // that the next piece is cut from
};

}  // namespace bodyopt::vulkan
