// Device memory. Tables and intermediate results live on the device. The host reaches them by staging buffers alone, so
// that code tested where all memory is shared works on a discrete GPU.
#pragma once

#include <compare>
#include <cstddef>
#include <memory>
#include <span>
#include <type_traits>
#include <vector>

#include "runtime/vulkan/device.h"
#include "runtime/vulkan/object.h"

namespace bodyopt::vulkan {

enum class Memory {
  device,
  fetched,  // on the device; the queue for copies reads it, too
  staging   // mapped for as long as the buffer lives, coherent; small things of one frame may be read where they are
};

class Buffer {
 public:
  Buffer() = default;
  // It has at least 16 bytes, so that an empty table can be bound. `name` is for messages. Throws Error(device).
  Buffer(const Device& device, VkDeviceSize bytes, Memory memory, const char* name);

  VkBuffer handle() const { return buffer_.get(); }
  VkDeviceSize size() const { return size_; }
  std::byte* mapped() const { return memory_.block->mapped + memory_.offset; }  // staging only
  const MemoryPiece& memory() const { return memory_; }

 private:
  VkDeviceSize size_ = 0;
  MemoryPiece memory_;
  Owned<VkBuffer, vkDestroyBuffer> buffer_;
};

// A device buffer of `count` floats.
inline Buffer floats(const Device& device, std::uint64_t count, const char* name) {
  return {device, count * sizeof(float), Memory::device, name};
}

// The part of a buffer that a kernel sees, in bytes.
struct BufferRange {
  BufferRange() = default;
  BufferRange(const Buffer& whole) : buffer(whole.handle()), offset(0), size(whole.size()) {}
  BufferRange(const Buffer& b, VkDeviceSize offset_, VkDeviceSize size_)
      : buffer(b.handle()), offset(offset_), size(size_) {}
  BufferRange(VkBuffer b, VkDeviceSize offset_, VkDeviceSize size_) : buffer(b), offset(offset_), size(size_) {}
  auto operator<=>(const BufferRange&) const = default;

  VkBuffer buffer = VK_NULL_HANDLE;
  VkDeviceSize offset = 0, size = 0;
};

class Commands;

// Device buffers that are filled together: in one submission, or, of more than is staged at once, in few.
class Uploads {
 public:
  explicit Uploads(const Device& device);
  ~Uploads();
  // Holds a copy of `bytes` after finish(). Throws Error(device).
  Buffer add(std::span<const std::byte> bytes, const char* name);
  void finish();  // throws Error(device)

 private:
  const Device& device_;
  const std::unique_ptr<Commands> commands_;
  std::vector<Buffer> staging_;
  std::size_t staged_ = 0;  // bytes
};

// A device buffer that holds a copy of `bytes`. Throws Error(device).
Buffer upload_bytes(const Device& device, std::span<const std::byte> bytes, const char* name);
inline Buffer upload_bytes(Uploads& uploads, std::span<const std::byte> bytes, const char* name) {
  return uploads.add(bytes, name);
}

// to: a device, or Uploads.
template <typename To, typename T>
Buffer upload(To& to, const std::vector<T>& values, const char* name) {
  static_assert(std::is_trivially_copyable_v<T>);
  return upload_bytes(to, std::as_bytes(std::span(values)), name);
}

// Buffers that are made of Uploads and these arguments.
template <typename Buffers, typename... Arguments>
Buffers upload_together(const Device& device, const Arguments&... arguments) {
  Uploads uploads(device);
  Buffers buffers(uploads, arguments...);
  uploads.finish();
  return buffers;
}

// Throws Error(device) that names the table where it is larger than one binding can be.
void require_binding(std::size_t bytes, const char* name, const DeviceInfo& limits);

// A table that kernels read here and there, so that one binding has to see all of it. Throws as require_binding.
template <typename To, typename T>
Buffer upload_whole(To& to, const std::vector<T>& values, const char* name, const DeviceInfo& limits) {
  require_binding(values.size() * sizeof(T), name, limits);
  return upload(to, values, name);
}

}  // namespace bodyopt::vulkan
