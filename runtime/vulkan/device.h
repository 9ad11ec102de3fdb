// A Vulkan device: how it is listed, chosen and opened.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <type_traits>
#include <typeindex>
#include <vector>

#include "runtime/vulkan/instance.h"
#include "runtime/vulkan/memory.h"
#include "runtime/vulkan/pipeline_cache.h"

namespace bodyopt {
struct DeviceChoice;
}

namespace bodyopt::vulkan {

struct DeviceInfo {
  std::uint32_t index = 0;                      // as a user names it
  std::string name, type, api_version, driver;  // type: discrete, integrated, virtual, cpu or other
  std::uint64_t memory_bytes = 0;               // largest device-local heap
  std::uint64_t max_storage_buffer_range = 0;   // bytes one binding can see
  std::uint64_t storage_alignment = 0;          // bytes, of binding offsets
  std::uint32_t max_groups_x = 0;               // workgroups of one dispatch
  std::uint32_t max_groups_y = 0;
  bool draws = false;   // whether its queue can also draw
  std::string problem;  // why the device cannot be used; empty when it can
};

// All devices of this machine, in the order of their indices. Throws Error(device) when Vulkan itself fails.
std::vector<DeviceInfo> list_devices();

// Returns the index of the device that `name` means. It is "auto" (discrete, then integrated or virtual, then CPU), an
// index, or part of a name in any case: the first match. Throws Error(device) that names what exists.
std::uint32_t choose_device(const std::vector<DeviceInfo>& devices, const std::string& name);

// The uses of a device beside computing.
struct DeviceUse {
  bool draws = false;
  std::vector<const char*> instance_extensions{}, extensions{};  // of a window
};

// A device that the host program has opened, with a queue of its family that computes.
struct HostDevice {
  VkInstance instance;
  VkPhysicalDevice physical;
  VkDevice device;
  VkQueue queue;
  std::uint32_t queue_family;
  VkPipelineCache pipeline_cache = VK_NULL_HANDLE;             // none, or the host keeps it
  PFN_vkGetInstanceProcAddr get_instance_proc_addr = nullptr;  // of the host's loader; null: the system's
};

// An open device with one queue that computes, and draws where the device can, and one that copies beside it where the
// device has such.
class Device {
 public:
  // Throws Error(device) when there is no such device, or none for this use.
  explicit Device(const DeviceChoice& choice, const DeviceUse& use = {});
  // The host's, which must outlive it. Throws Error(usage) for null handles, Error(device) where the device, the queue
  // or the loader does not do.
  explicit Device(const HostDevice& host);
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  VkInstance instance() const { return instance_.handle(); }
  VkPhysicalDevice physical() const { return physical_; }
  VkDevice handle() const { return device_; }
  VkQueue queue() const { return queue_; }
  std::mutex& queue_mutex() const { return queue_mutex_; }  // held while work is submitted: one thread at a time may
  std::uint32_t queue_family() const { return queue_family_; }
  // For copies alone; those of queue() where the device, or the host program, has none. The mutex is for both.
  VkQueue copy_queue() const { return copy_queue_; }
  std::uint32_t copy_family() const { return copy_family_; }
  const DeviceInfo& info() const { return info_; }
  // Whether it is a software device that nobody asked for by name: kernels are then the CPU's, many times as quick.
  bool only_draws() const { return only_draws_; }
  // Seconds per timestamp tick, 0 when the queue has no timestamps; the bits of a timestamp that count.
  double timestamp_period() const { return timestamp_period_; }
  std::uint64_t timestamp_mask() const { return timestamp_mask_; }

  // A memory type out of `type_bits` with the required properties, with the preferred ones where there is one.
  // Throws Error(device).
  std::uint32_t memory_type(std::uint32_t type_bits, VkMemoryPropertyFlags required,
                            VkMemoryPropertyFlags preferred) const;
  // Bytes of the heap that memory of a type is taken from.
  VkDeviceSize heap_bytes(std::uint32_t memory_type) const {
    return memory_.memoryHeaps[memory_.memoryTypes[memory_type].heapIndex].size;
  }

  MemoryBlocks& memory_blocks() const { return memory_blocks_; }
  VkPipelineCache pipeline_cache() const { return pipeline_cache_; }  // VK_NULL_HANDLE: none
  // A T(*this) for all users of the device, as drivers take long to compile pipelines. Any thread may call this; the
  // first call makes it, and it goes before the device. Throws as T's constructor, which must not call shared().
  template <typename T>
  const T& shared() const {
    const std::lock_guard lock(shared_mutex_);
    std::shared_ptr<const void>& made = shared_[typeid(T)];
    if (!made) made = std::make_shared<const T>(*this);
    return *static_cast<const T*>(made.get());
  }

  std::vector<std::string> validation_messages() const { return instance_.log()->messages(); }
  std::shared_ptr<const ValidationLog> validation_log() const { return instance_.log(); }

 private:
  struct Destroy {
    void operator()(VkDevice device) const { vkDestroyDevice(device, nullptr); }
  };

  void describe_queue();

  Instance instance_;
  DeviceInfo info_;
  bool only_draws_ = false;
  VkPhysicalDeviceMemoryProperties memory_{};
  std::uint32_t queue_family_ = 0, copy_family_ = 0;
  double timestamp_period_ = 0;
  std::uint64_t timestamp_mask_ = 0;
  VkPhysicalDevice physical_ = VK_NULL_HANDLE;
  VkDevice device_ = VK_NULL_HANDLE;
  // Owns the device where it is ours. It goes after all that is made of it and before the instance, even where the
  // constructor got no further.
  std::unique_ptr<std::remove_pointer_t<VkDevice>, Destroy> ours_;
  VkQueue queue_ = VK_NULL_HANDLE, copy_queue_ = VK_NULL_HANDLE;
  mutable std::mutex queue_mutex_;
  mutable MemoryBlocks memory_blocks_;
  std::optional<PipelineCache> kept_pipelines_;  // of a device of ours
  VkPipelineCache pipeline_cache_ = VK_NULL_HANDLE;
  mutable std::mutex shared_mutex_;
  mutable std::map<std::type_index, std::shared_ptr<const void>> shared_;
};

}  // namespace bodyopt::vulkan
