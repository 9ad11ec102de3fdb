#include "runtime/vulkan/buffer.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "runtime/core/error.h"
#include "runtime/vulkan/commands.h"

namespace bodyopt::vulkan {
namespace {

constexpr VkDeviceSize kMinBytes = 16;
constexpr std::size_t kMostStaged = std::size_t{64} << 20;  // bytes; of one table as many as it has

}  // namespace

Buffer::Buffer(const Device& device, VkDeviceSize bytes, Memory memory, const char* name)
    : size_(std::max(kMinBytes, (bytes + 3) / 4 * 4)) {
  auto info = structure<VkBufferCreateInfo>(VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO);
  info.size = size_;
  info.usage = VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT | VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;
  if (memory == Memory::device) info.usage |= VK_BUFFER_USAGE_INDEX_BUFFER_BIT;  // triangles are drawn where they are
  const std::array families = {device.queue_family(), device.copy_family()};
  if (memory == Memory::fetched && families[0] != families[1]) {
    info.sharingMode = VK_SHARING_MODE_CONCURRENT;
    info.queueFamilyIndexCount = families.size();
    info.pQueueFamilyIndices = families.data();
  }
  const VkDevice handle = device.handle();
  const auto require = [&](VkResult result, const char* call) {
    if (result == VK_SUCCESS) return;
    check(result, (std::string(call) + " of " + std::to_string(size_) + " bytes for " + name).c_str());
  };
  VkBuffer buffer = VK_NULL_HANDLE;
  require(vkCreateBuffer(handle, &info, nullptr, &buffer), "vkCreateBuffer");
  buffer_ = {handle, buffer};

  VkMemoryRequirements needs{};
  vkGetBufferMemoryRequirements(handle, buffer, &needs);
  const std::uint32_t type =
      memory != Memory::staging
          ? device.memory_type(needs.memoryTypeBits, 0, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT)
          : device.memory_type(needs.memoryTypeBits,
                               VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT,
                               VK_MEMORY_PROPERTY_HOST_CACHED_BIT);
  if (needs.size > device.heap_bytes(type)) {
    throw Error(ErrorKind::device, name, ": ", needs.size, " bytes do not fit the ", device.heap_bytes(type),
                " bytes of memory of '", device.info().name, "'");
  }
  memory_ = device.memory_blocks().take(handle, needs, {type, memory == Memory::staging}, name);
  require(vkBindBufferMemory(handle, buffer, memory_.block->memory.get(), memory_.offset), "vkBindBufferMemory");
}

void require_binding(std::size_t bytes, const char* name, const DeviceInfo& limits) {
  if (bytes <= limits.max_storage_buffer_range) return;
  throw Error(ErrorKind::device, name, ": ", bytes,
              " bytes, which kernels need at "
              "once, are more than the ",
              limits.max_storage_buffer_range, " bytes that a binding of '", limits.name,
              "' can see; the CPU has no such limit");
}

Uploads::Uploads(const Device& device) : device_(device), commands_(std::make_unique<Commands>(device)) {}

Uploads::~Uploads() = default;

Buffer Uploads::add(std::span<const std::byte> bytes, const char* name) {
  Buffer buffer(device_, bytes.size(), Memory::device, name);
  if (bytes.empty()) return buffer;
  if (staged_ + bytes.size() > kMostStaged) finish();
  if (staging_.empty()) commands_->begin();
  const Buffer& staging = staging_.emplace_back(device_, bytes.size(), Memory::staging, name);
  std::memcpy(staging.mapped(), bytes.data(), bytes.size());
  commands_->copy(staging, buffer);
  staged_ += bytes.size();
  return buffer;
}

void Uploads::finish() {
  if (staging_.empty()) return;
  commands_->end();
  commands_->run();
  staging_.clear();
  staged_ = 0;
}

Buffer upload_bytes(const Device& device, std::span<const std::byte> bytes, const char* name) {
  Uploads uploads(device);
  Buffer buffer = uploads.add(bytes, name);
  uploads.finish();
  return buffer;
}

}  // namespace bodyopt::vulkan
