// Vulkan's structures and objects in C++.
#pragma once

#include <utility>

#include "runtime/vulkan/functions.h"

namespace bodyopt::vulkan {

// A structure of which all but the type is zero.
template <typename Structure>
Structure structure(VkStructureType type) {
  Structure result{};
  result.sType = type;
  return result;
}

// Owns one Vulkan object of a device and destroys it with the function named in its type.
template <typename Handle, auto& Destroy>
class Owned {
 public:
  Owned() = default;
  Owned(VkDevice device, Handle handle) : device_(device), handle_(handle) {}
  Owned(Owned&& other) noexcept : device_(other.device_), handle_(std::exchange(other.handle_, Handle{})) {}
  Owned& operator=(Owned&& other) noexcept {
    std::swap(device_, other.device_);
    std::swap(handle_, other.handle_);
    return *this;
  }
  ~Owned() {
    if (handle_ != Handle{}) Destroy(device_, handle_, nullptr);
  }
  Handle get() const { return handle_; }

 private:
  VkDevice device_ = VK_NULL_HANDLE;
  Handle handle_{};
};

}  // namespace bodyopt::vulkan
