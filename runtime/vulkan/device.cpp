#include "runtime/vulkan/device.h"

#include <algorithm>
#include <set>

#include "runtime/core/error.h"
#include "runtime/core/text.h"
#include "runtime/host/device_choice.h"
#include "runtime/vulkan/object.h"

namespace bodyopt::vulkan {
namespace {

constexpr std::uint32_t kMinStorageBindings = BODYOPT_MOST_BINDINGS;  // of the kernel that has most

std::string version_text(std::uint32_t version) {
  return std::to_string(VK_API_VERSION_MAJOR(version)) + "." + std::to_string(VK_API_VERSION_MINOR(version)) + "." +
         std::to_string(VK_API_VERSION_PATCH(version));
}

const char* type_name(VkPhysicalDeviceType type) {
  if (type == VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU) return "discrete";
  if (type == VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU) return "integrated";
  if (type == VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU) return "virtual";
  return type == VK_PHYSICAL_DEVICE_TYPE_CPU ? "cpu" : "other";
}

int preference(const std::string& type) {
  if (type == "discrete") return 0;
  if (type == "integrated" || type == "virtual") return 1;
  return type == "cpu" ? 2 : 3;
}

std::vector<VkQueueFamilyProperties> queue_families(VkPhysicalDevice physical) {
  std::uint32_t count = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, families.data());
  return families;
}

// A family that computes, with graphics where there is one.
std::optional<std::uint32_t> compute_family(VkPhysicalDevice physical) {
  const std::vector<VkQueueFamilyProperties> families = queue_families(physical);
  constexpr VkQueueFlags kComputes = VK_QUEUE_COMPUTE_BIT, kDraws = VK_QUEUE_GRAPHICS_BIT;
  for (const VkQueueFlags wanted : {kComputes | kDraws, kComputes}) {
    for (std::uint32_t f = 0; f < families.size(); ++f) {
      if ((families[f].queueFlags & wanted) == wanted) return f;
    }
  }
  return std::nullopt;
}

// A family that copies and nothing else, as hardware does beside computing; or the one that computes.
std::uint32_t copy_family(VkPhysicalDevice physical, std::uint32_t computes) {
  constexpr VkQueueFlags kBeside = VK_QUEUE_SPARSE_BINDING_BIT | VK_QUEUE_PROTECTED_BIT;
  const std::vector<VkQueueFamilyProperties> families = queue_families(physical);
  for (std::uint32_t f = 0; f < families.size(); ++f) {
    if (families[f].queueCount > 0 && (families[f].queueFlags & ~kBeside) == VK_QUEUE_TRANSFER_BIT) return f;
  }
  return computes;
}

std::string find_problem(VkPhysicalDevice physical, const VkPhysicalDeviceProperties& properties) {
  if (properties.apiVersion < VK_API_VERSION_1_2) return "needs Vulkan 1.2 or newer";
  if (!compute_family(physical)) return "has no compute queue";
  const std::uint32_t bindings = properties.limits.maxPerStageDescriptorStorageBuffers;
  if (bindings < kMinStorageBindings) return "has only " + std::to_string(bindings) + " storage buffers per shader";
  return {};
}

DeviceInfo describe(VkPhysicalDevice physical, std::uint32_t index) {
  VkPhysicalDeviceProperties properties{};
  vkGetPhysicalDeviceProperties(physical, &properties);
  DeviceInfo info;
  info.index = index;
  info.name = properties.deviceName;
  info.type = type_name(properties.deviceType);
  info.api_version = version_text(properties.apiVersion);
  info.driver = version_text(properties.driverVersion);
  info.max_storage_buffer_range = properties.limits.maxStorageBufferRange;
  info.storage_alignment = properties.limits.minStorageBufferOffsetAlignment;
  info.max_groups_x = properties.limits.maxComputeWorkGroupCount[0];
  info.max_groups_y = properties.limits.maxComputeWorkGroupCount[1];
  info.problem = find_problem(physical, properties);
  if (const std::optional<std::uint32_t> family = compute_family(physical)) {
    info.draws = queue_families(physical)[*family].queueFlags & VK_QUEUE_GRAPHICS_BIT;
  }
  if (properties.apiVersion >= VK_API_VERSION_1_2) {
    auto driver = structure<VkPhysicalDeviceDriverProperties>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES);
    auto properties2 = structure<VkPhysicalDeviceProperties2>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2);
    properties2.pNext = &driver;
    vkGetPhysicalDeviceProperties2(physical, &properties2);
    info.driver = std::string(driver.driverName) + " " + driver.driverInfo;
  }
  VkPhysicalDeviceMemoryProperties memory{};
  vkGetPhysicalDeviceMemoryProperties(physical, &memory);
  for (std::uint32_t h = 0; h < memory.memoryHeapCount; ++h) {
    if (memory.memoryHeaps[h].flags & VK_MEMORY_HEAP_DEVICE_LOCAL_BIT) {
      info.memory_bytes = std::max<std::uint64_t>(info.memory_bytes, memory.memoryHeaps[h].size);
    }
  }
  return info;
}

std::vector<DeviceInfo> describe_all(const std::vector<VkPhysicalDevice>& physical) {
  std::vector<DeviceInfo> devices;
  for (std::uint32_t i = 0; i < physical.size(); ++i) devices.push_back(describe(physical[i], i));
  return devices;
}

const DeviceInfo* find_device(const std::vector<DeviceInfo>& devices, const std::string& name) {
  const DeviceInfo* found = nullptr;
  const bool is_index = !name.empty() && std::ranges::all_of(name, [](char c) { return '0' <= c && c <= '9'; });
  for (const DeviceInfo& device : devices) {
    if (name == "auto") {
      if (device.problem.empty() && (!found || preference(device.type) < preference(found->type))) found = &device;
    } else if (!found && is_index) {
      if (std::to_string(device.index) == name) found = &device;
    } else if (!found && !name.empty()) {
      if (lower_case(device.name).find(lower_case(name)) != std::string::npos) found = &device;
    }
  }
  return found;
}

std::string listing(const std::vector<DeviceInfo>& devices) {
  if (const std::string missing = missing_functions(); !missing.empty()) return missing;
  if (devices.empty()) {
    return "this machine has no Vulkan device (Debian package with a software one: mesa-vulkan-drivers)";
  }
  std::string text = "devices here:";
  for (const DeviceInfo& device : devices) {
    text += " [" + std::to_string(device.index) + "] " + device.name + " (" + device.type + ")";
    if (!device.problem.empty()) text += ", unusable: it " + device.problem;
    text += device.index + 1 < devices.size() ? ";" : "";
  }
  return text;
}

bool device_extension_offered(VkPhysicalDevice physical, const char* name) {
  return lists_extension(enumerate<VkExtensionProperties>("vkEnumerateDeviceExtensionProperties",
                                                          [&](auto* count, auto* items) {
                                                            return vkEnumerateDeviceExtensionProperties(
                                                                physical, nullptr, count, items);
                                                          }),
                         name);
}

// With a queue of each family.
VkDevice open_device(VkPhysicalDevice physical, const std::set<std::uint32_t>& families,
                     std::vector<const char*> extensions) {
  const float priority = 1.0f;
  std::vector<VkDeviceQueueCreateInfo> queues;
  for (const std::uint32_t family : families) {
    auto queue = structure<VkDeviceQueueCreateInfo>(VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO);
    queue.queueFamilyIndex = family;
    queue.queueCount = 1;
    queue.pQueuePriorities = &priority;
    queues.push_back(queue);
  }
  auto info = structure<VkDeviceCreateInfo>(VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO);
  info.queueCreateInfoCount = static_cast<std::uint32_t>(queues.size());
  info.pQueueCreateInfos = queues.data();
  // A device that offers this extension (Vulkan on Metal) insists on it.
  const char* const portability = "VK_KHR_portability_subset";
  if (device_extension_offered(physical, portability)) extensions.push_back(portability);
  info.enabledExtensionCount = static_cast<std::uint32_t>(extensions.size());
  info.ppEnabledExtensionNames = extensions.data();
  VkDevice device = VK_NULL_HANDLE;
  check(vkCreateDevice(physical, &info, nullptr, &device), "vkCreateDevice");
  return device;
}

// Says what a device lacks for a use, as its problem.
void find_unfit(VkPhysicalDevice physical, const DeviceUse& use, DeviceInfo& device) {
  if (!device.problem.empty()) return;
  if (use.draws && !device.draws) device.problem = "cannot draw, only compute";
  for (const char* extension : use.extensions) {
    if (!device_extension_offered(physical, extension)) device.problem = std::string("does not offer ") + extension;
  }
}

const HostDevice& with_handles(const HostDevice& host) {
  if (host.instance && host.physical && host.device && host.queue) return host;
  throw Error(ErrorKind::usage, "the instance, physical device, device or queue of the host's Vulkan is a null handle");
}

}  // namespace

std::vector<DeviceInfo> list_devices() { return describe_all(Instance(false).physical_devices()); }

std::uint32_t choose_device(const std::vector<DeviceInfo>& devices, const std::string& name) {
  const DeviceInfo* found = find_device(devices, name);
  if (!found) {
    const std::string wanted = name == "auto" ? "no usable Vulkan device" : "no Vulkan device '" + name + "'";
    throw Error(ErrorKind::device, wanted, "; ", listing(devices));
  }
  if (!found->problem.empty()) {
    throw Error(ErrorKind::device, "the Vulkan device '", found->name, "' ", found->problem, "; ", listing(devices));
  }
  return found->index;
}

Device::Device(const DeviceChoice& choice, const DeviceUse& use)
    : instance_(choice.validation, use.instance_extensions) {
  const std::vector<VkPhysicalDevice> physical_devices = instance_.physical_devices();
  std::vector<DeviceInfo> devices = describe_all(physical_devices);
  for (DeviceInfo& device : devices) find_unfit(physical_devices[device.index], use, device);
  info_ = devices[choose_device(devices, choice.name)];
  only_draws_ = use.draws && choice.name == "auto" && info_.type == "cpu";
  physical_ = physical_devices[info_.index];
  queue_family_ = *compute_family(physical_);
  copy_family_ = vulkan::copy_family(physical_, queue_family_);
  describe_queue();
  ours_.reset(open_device(physical_, {queue_family_, copy_family_}, use.extensions));
  device_ = ours_.get();
  vkGetDeviceQueue(device_, queue_family_, 0, &queue_);
  vkGetDeviceQueue(device_, copy_family_, 0, &copy_queue_);
  kept_pipelines_.emplace(physical_, device_, choice.pipeline_cache);
  pipeline_cache_ = kept_pipelines_->handle();
}

Device::Device(const HostDevice& host)
    : instance_(with_handles(host).instance, host.get_instance_proc_addr),
      queue_family_(host.queue_family),
      copy_family_(host.queue_family),
      physical_(host.physical),
      device_(host.device),
      queue_(host.queue),
      copy_queue_(host.queue),
      pipeline_cache_(host.pipeline_cache) {
  info_ = describe(physical_, 0);
  if (!info_.problem.empty()) {
    throw Error(ErrorKind::device, "the host's Vulkan device '", info_.name, "' ", info_.problem);
  }
  const std::vector<VkQueueFamilyProperties> families = queue_families(physical_);
  if (queue_family_ >= families.size() || !(families[queue_family_].queueFlags & VK_QUEUE_COMPUTE_BIT)) {
    throw Error(ErrorKind::device, "the queue family ", queue_family_, " of '", info_.name,
                "' does not compute, or is none of its ", families.size());
  }
  describe_queue();
}

// Memory and timestamps.
void Device::describe_queue() {
  vkGetPhysicalDeviceMemoryProperties(physical_, &memory_);
  const std::uint32_t bits = queue_families(physical_)[queue_family_].timestampValidBits;
  if (bits > 0) {
    VkPhysicalDeviceProperties properties{};
    vkGetPhysicalDeviceProperties(physical_, &properties);
    timestamp_period_ = 1e-9 * static_cast<double>(properties.limits.timestampPeriod);
    timestamp_mask_ = bits >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << bits) - 1;
  }
}

std::uint32_t Device::memory_type(std::uint32_t type_bits, VkMemoryPropertyFlags required,
                                  VkMemoryPropertyFlags preferred) const {
  for (const VkMemoryPropertyFlags wanted : {required | preferred, required}) {
    for (std::uint32_t t = 0; t < memory_.memoryTypeCount; ++t) {
      if ((type_bits >> t & 1u) && (memory_.memoryTypes[t].propertyFlags & wanted) == wanted) return t;
    }
  }
  throw Error(ErrorKind::device, "the Vulkan device '", info_.name, "' has no memory of the kind needed");
}

}  // namespace bodyopt::vulkan
