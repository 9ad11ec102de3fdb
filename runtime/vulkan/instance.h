// The Vulkan instance, with the validation layers when asked for.
#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "runtime/vulkan/functions.h"

namespace bodyopt::vulkan {

// Throws Error(device) that names the call and the result, unless the result is a success.
void check(VkResult result, const char* call);

// Lists what Vulkan gives in two calls: call(&count, nullptr) for the number, call(&count, items) for the items.
// Throws as check().
template <typename Item, typename Call>
std::vector<Item> enumerate(const char* name, const Call& call) {
  std::uint32_t count = 0;
  check(call(&count, static_cast<Item*>(nullptr)), name);
  std::vector<Item> items(count);
  check(call(&count, items.data()), name);
  items.resize(count);
  return items;
}

bool lists_extension(const std::vector<VkExtensionProperties>& extensions, const char* name);

// Messages of the validation layers (type VALIDATION, warning or above). Outlives the instance, to hear its teardown.
class ValidationLog {
 public:
  void add(std::string message);
  std::vector<std::string> messages() const;

 private:
  mutable std::mutex mutex_;
  std::vector<std::string> messages_;
};

class Instance {
 public:
  // With validation, turns on the Khronos layer and synchronization validation. Throws Error(device) when the layer is
  // not installed, or an extension is not offered. A machine without any Vulkan driver, or without
  // Vulkan's loader, gives an instance without devices.
  explicit Instance(bool validation, const std::vector<const char*>& extensions = {});
  // An instance of the host program, which must outlive it, and of the loader that `find` is of; null: the system's.
  // Throws Error(device) where that loader is missing, or another one is in use.
  Instance(VkInstance host, PFN_vkGetInstanceProcAddr find);
  ~Instance();
  Instance(const Instance&) = delete;
  Instance& operator=(const Instance&) = delete;

  std::vector<VkPhysicalDevice> physical_devices() const;
  VkInstance handle() const { return handle_; }
  std::shared_ptr<const ValidationLog> log() const { return log_; }

 private:
  std::shared_ptr<ValidationLog> log_;
  VkInstance handle_ = VK_NULL_HANDLE;
  bool is_ours_ = true;
  VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
};

}  // namespace bodyopt::vulkan
