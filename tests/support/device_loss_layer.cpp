// A Vulkan layer that loses the device as drivers do: from one call on, nothing works any more. Which call, the
// environment says: BODYOPT_LOSE_DEVICE="vkQueueSubmit 5" is the fifth submission; or that it is to be now, while
// BODYOPT_LOSE_DEVICE_NOW is set. For one device at a time.
// With BODYOPT_FAIL_ALLOCATION=5, the fifth allocation of memory fails, and all after it.
// With BODYOPT_COUNT_CALLS=FILE, how many submissions, allocations of memory, buffers and descriptor sets there were is
// written to that file as the program ends, and how many submissions nobody had waited for yet at most.
// With BODYOPT_COPY_FAMILY set, the device has a further family, of one queue that copies and nothing else. What is
// submitted to it goes to the first queue of the first family, unless a device would fault it: where it does not wait
// for the first queue, nothing waits for it, or it copies out of buffers that are not for both.
// With BODYOPT_HEAP=BYTES no heap is larger.
// With BODYOPT_KEEP_PIPELINES=FILE, what the driver is given to begin a pipeline cache with is written to that file.
// With BODYOPT_OUT_OF_DATE set, the surface is out of date whenever something has been submitted since the last time it
// was: for every picture, once. With BODYOPT_HOLD_FIRST_PICTURE set, the program waits for ever before it shows its
// second picture: what the first looks like can be seen.
#include <unistd.h>
#include <vulkan/vk_layer.h>
#include <vulkan/vulkan.h>

#include <algorithm>
#include <atomic>
#include <climits>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace {

PFN_vkGetInstanceProcAddr next_of_instance = nullptr;
PFN_vkGetDeviceProcAddr next_of_device = nullptr;
VkInstance instance_here = VK_NULL_HANDLE;
VkDevice device_here = VK_NULL_HANDLE;
std::atomic<int> calls_left{0}, pictures_shown{0};
std::atomic<bool> is_lost{false}, has_submitted{false};

struct Plan {
  Plan() {
    const char* text = std::getenv("BODYOPT_LOSE_DEVICE");
    std::istringstream(text ? text : "") >> call >> count;
  }
  std::string call;
  int count = 0;
};

struct CallCounts {
  ~CallCounts() {
    const char* file = std::getenv("BODYOPT_COUNT_CALLS");
    if (!file) return;
    std::ofstream(file) << submissions << ' ' << allocations << ' ' << buffers << ' ' << sets << ' ' << most_unwaited;
  }
  std::atomic<int> submissions{0}, allocations{0}, buffers{0}, sets{0}, unwaited{0}, most_unwaited{0};
} counts;

const Plan& plan() {
  static const Plan plan;
  return plan;
}

template <typename Function, typename... Arguments>
VkResult go_on(const char* call, Arguments... arguments) {
  return reinterpret_cast<Function>(next_of_device(device_here, call))(arguments...);
}

// True from the planned call on.
bool loses(const char* call) {
  if (!is_lost && plan().call == call && --calls_left == 0) is_lost = true;
  if (std::getenv("BODYOPT_LOSE_DEVICE_NOW")) is_lost = true;
  return is_lost;
}

// The queue that copies: the loader finds its functions by the first word, as in any queue.
struct CopyQueue {
  void* functions;
} copy_queue{};
VkQueue first_queue = VK_NULL_HANDLE;
std::uint32_t copy_family = UINT32_MAX;  // none
PFN_vkGetPhysicalDeviceQueueFamilyProperties families_beneath = nullptr;
PFN_vkGetPhysicalDeviceMemoryProperties memory_beneath = nullptr;
std::set<VkBuffer> buffers_of_both;        // families
std::set<VkCommandPool> copying_pools;     // of the copy family
std::set<VkCommandBuffer> copying;         // likewise
std::set<VkSemaphore> signalled_by_first;  // and not waited for
bool copies_wrongly = false;

VkQueue as_copy_queue() { return reinterpret_cast<VkQueue>(&copy_queue); }

VKAPI_ATTR void VKAPI_CALL queue_families(VkPhysicalDevice physical, std::uint32_t* count,
                                          VkQueueFamilyProperties* families) {
  std::uint32_t own = 0;
  families_beneath(physical, &own, nullptr);
  const bool has_more = std::getenv("BODYOPT_COPY_FAMILY") != nullptr;
  if (families == nullptr) {
    *count = own + (has_more ? 1 : 0);
    return;
  }
  const std::uint32_t room = *count;
  families_beneath(physical, count, families);
  if (!has_more || room <= own) return;
  copy_family = own;
  families[own] = VkQueueFamilyProperties{VK_QUEUE_TRANSFER_BIT, 1, 64, {1, 1, 1}};
  *count = own + 1;
}

VKAPI_ATTR void VKAPI_CALL memory_properties(VkPhysicalDevice physical, VkPhysicalDeviceMemoryProperties* memory) {
  memory_beneath(physical, memory);
  const char* most = std::getenv("BODYOPT_HEAP");
  for (std::uint32_t h = 0; most && h < memory->memoryHeapCount; ++h) {
    memory->memoryHeaps[h].size = std::min<VkDeviceSize>(memory->memoryHeaps[h].size, std::strtoull(most, nullptr, 10));
  }
}

VKAPI_ATTR void VKAPI_CALL device_queue(VkDevice device, std::uint32_t family, std::uint32_t index, VkQueue* queue) {
  const auto next = reinterpret_cast<PFN_vkGetDeviceQueue>(next_of_device(device, "vkGetDeviceQueue"));
  next(device, family == copy_family ? 0 : family, index, queue);
  if (family != copy_family) return;
  first_queue = *queue;
  copy_queue = *reinterpret_cast<const CopyQueue*>(first_queue);
  *queue = as_copy_queue();
}

VKAPI_ATTR VkResult VKAPI_CALL create_command_pool(VkDevice device, const VkCommandPoolCreateInfo* info,
                                                   const VkAllocationCallbacks* allocator, VkCommandPool* pool) {
  VkCommandPoolCreateInfo own = *info;
  if (own.queueFamilyIndex == copy_family) own.queueFamilyIndex = 0;
  const VkResult result = go_on<PFN_vkCreateCommandPool>("vkCreateCommandPool", device, &own, allocator, pool);
  if (info->queueFamilyIndex == copy_family) copying_pools.insert(*pool);
  return result;
}

VKAPI_ATTR VkResult VKAPI_CALL allocate_commands(VkDevice device, const VkCommandBufferAllocateInfo* info,
                                                 VkCommandBuffer* commands) {
  const VkResult result = go_on<PFN_vkAllocateCommandBuffers>("vkAllocateCommandBuffers", device, info, commands);
  if (copying_pools.contains(info->commandPool)) copying.insert(commands, commands + info->commandBufferCount);
  return result;
}

VKAPI_ATTR void VKAPI_CALL copy_buffer(VkCommandBuffer commands, VkBuffer from, VkBuffer to, std::uint32_t count,
                                       const VkBufferCopy* regions) {
  if (copying.contains(commands) && !buffers_of_both.contains(from)) copies_wrongly = true;
  reinterpret_cast<PFN_vkCmdCopyBuffer>(next_of_device(device_here, "vkCmdCopyBuffer"))(commands, from, to, count,
                                                                                        regions);
}

// Of what is copied beside the first queue.
bool is_in_order(const VkSubmitInfo& submit, VkFence fence) {
  bool waits = false;
  for (std::uint32_t k = 0; k < submit.waitSemaphoreCount; ++k) {
    waits = signalled_by_first.erase(submit.pWaitSemaphores[k]) > 0 || waits;
  }
  return waits && fence != VK_NULL_HANDLE && !copies_wrongly;
}

VKAPI_ATTR VkResult VKAPI_CALL queue_submit(VkQueue queue, std::uint32_t count, const VkSubmitInfo* submits,
                                            VkFence fence) {
  ++counts.submissions;
  counts.most_unwaited = std::max(++counts.unwaited, counts.most_unwaited.load());
  if (queue == as_copy_queue()) {
    queue = first_queue;
    if (!is_in_order(*submits, fence)) return VK_ERROR_DEVICE_LOST;
  } else if (copy_family != UINT32_MAX && submits->signalSemaphoreCount > 0) {
    signalled_by_first.insert(*submits->pSignalSemaphores);
  }
  if (loses("vkQueueSubmit")) return VK_ERROR_DEVICE_LOST;
  has_submitted = true;
  return go_on<PFN_vkQueueSubmit>("vkQueueSubmit", queue, count, submits, fence);
}

VKAPI_ATTR VkResult VKAPI_CALL create_pipeline_cache(VkDevice device, const VkPipelineCacheCreateInfo* info,
                                                     const VkAllocationCallbacks* allocator, VkPipelineCache* cache) {
  if (const char* file = std::getenv("BODYOPT_KEEP_PIPELINES")) {
    std::ofstream(file, std::ios::binary)
        .write(static_cast<const char*>(info->pInitialData), static_cast<std::streamsize>(info->initialDataSize));
  }
  return go_on<PFN_vkCreatePipelineCache>("vkCreatePipelineCache", device, info, allocator, cache);
}

VKAPI_ATTR VkResult VKAPI_CALL allocate_memory(VkDevice device, const VkMemoryAllocateInfo* info,
                                               const VkAllocationCallbacks* allocator, VkDeviceMemory* memory) {
  const char* first_to_fail = std::getenv("BODYOPT_FAIL_ALLOCATION");
  if (++counts.allocations >= (first_to_fail ? std::atoi(first_to_fail) : INT_MAX)) {
    return VK_ERROR_OUT_OF_DEVICE_MEMORY;
  }
  return go_on<PFN_vkAllocateMemory>("vkAllocateMemory", device, info, allocator, memory);
}

VKAPI_ATTR VkResult VKAPI_CALL create_buffer(VkDevice device, const VkBufferCreateInfo* info,
                                             const VkAllocationCallbacks* allocator, VkBuffer* buffer) {
  ++counts.buffers;
  VkBufferCreateInfo own = *info;
  if (copy_family != UINT32_MAX) own.sharingMode = VK_SHARING_MODE_EXCLUSIVE;
  const VkResult result = go_on<PFN_vkCreateBuffer>("vkCreateBuffer", device, &own, allocator, buffer);
  if (info->sharingMode == VK_SHARING_MODE_CONCURRENT) buffers_of_both.insert(*buffer);
  return result;
}

VKAPI_ATTR VkResult VKAPI_CALL allocate_sets(VkDevice device, const VkDescriptorSetAllocateInfo* info,
                                             VkDescriptorSet* sets) {
  counts.sets += static_cast<int>(info->descriptorSetCount);
  return go_on<PFN_vkAllocateDescriptorSets>("vkAllocateDescriptorSets", device, info, sets);
}

// Waits before it loses: what was submitted ends on the device beneath, which is well.
VKAPI_ATTR VkResult VKAPI_CALL wait_for_fences(VkDevice device, std::uint32_t count, const VkFence* fences,
                                               VkBool32 all, std::uint64_t timeout) {
  if (is_lost) return VK_ERROR_DEVICE_LOST;
  const VkResult result = go_on<PFN_vkWaitForFences>("vkWaitForFences", device, count, fences, all, timeout);
  --counts.unwaited;
  return loses("vkWaitForFences") ? VK_ERROR_DEVICE_LOST : result;
}

VKAPI_ATTR VkResult VKAPI_CALL acquire_next_image(VkDevice device, VkSwapchainKHR chain, std::uint64_t timeout,
                                                  VkSemaphore semaphore, VkFence fence, std::uint32_t* image) {
  if (loses("vkAcquireNextImageKHR")) return VK_ERROR_DEVICE_LOST;
  if (std::getenv("BODYOPT_OUT_OF_DATE") && has_submitted.exchange(false)) return VK_ERROR_OUT_OF_DATE_KHR;
  return go_on<PFN_vkAcquireNextImageKHR>("vkAcquireNextImageKHR", device, chain, timeout, semaphore, fence, image);
}

VKAPI_ATTR VkResult VKAPI_CALL queue_present(VkQueue queue, const VkPresentInfoKHR* info) {
  if (loses("vkQueuePresentKHR")) return VK_ERROR_DEVICE_LOST;
  const bool holds = std::getenv("BODYOPT_HOLD_FIRST_PICTURE") && pictures_shown++ > 0;
  while (holds) pause();
  return go_on<PFN_vkQueuePresentKHR>("vkQueuePresentKHR", queue, info);
}

VKAPI_ATTR VkResult VKAPI_CALL device_wait_idle(VkDevice device) {
  const VkResult result = go_on<PFN_vkDeviceWaitIdle>("vkDeviceWaitIdle", device);
  return is_lost ? VK_ERROR_DEVICE_LOST : result;
}

VKAPI_ATTR VkResult VKAPI_CALL query_results(VkDevice device, VkQueryPool pool, std::uint32_t first,
                                             std::uint32_t count, std::size_t size, void* data, VkDeviceSize stride,
                                             VkQueryResultFlags flags) {
  if (is_lost) return VK_ERROR_DEVICE_LOST;
  return go_on<PFN_vkGetQueryPoolResults>("vkGetQueryPoolResults", device, pool, first, count, size, data, stride,
                                          flags);
}

// The layer's own link in the chain that the loader hands down.
template <typename LayerInfo>
LayerInfo* link_info(const void* chain, VkStructureType type) {
  for (auto* at = static_cast<const VkBaseInStructure*>(chain); at; at = at->pNext) {
    auto* info = const_cast<LayerInfo*>(reinterpret_cast<const LayerInfo*>(at));
    if (at->sType == type && info->function == VK_LAYER_LINK_INFO) return info;
  }
  return nullptr;
}

VKAPI_ATTR VkResult VKAPI_CALL create_instance(const VkInstanceCreateInfo* info, const VkAllocationCallbacks* allocator,
                                               VkInstance* instance) {
  auto*& link =
      link_info<VkLayerInstanceCreateInfo>(info->pNext, VK_STRUCTURE_TYPE_LOADER_INSTANCE_CREATE_INFO)->u.pLayerInfo;
  next_of_instance = link->pfnNextGetInstanceProcAddr;
  link = link->pNext;
  const auto create = reinterpret_cast<PFN_vkCreateInstance>(next_of_instance(VK_NULL_HANDLE, "vkCreateInstance"));
  const VkResult result = create(info, allocator, instance);
  instance_here = *instance;
  // Later the loader would give the layer's own.
  memory_beneath = reinterpret_cast<PFN_vkGetPhysicalDeviceMemoryProperties>(
      next_of_instance(*instance, "vkGetPhysicalDeviceMemoryProperties"));
  families_beneath = reinterpret_cast<PFN_vkGetPhysicalDeviceQueueFamilyProperties>(
      next_of_instance(*instance, "vkGetPhysicalDeviceQueueFamilyProperties"));
  return result;
}

VKAPI_ATTR VkResult VKAPI_CALL create_device(VkPhysicalDevice physical, const VkDeviceCreateInfo* info,
                                             const VkAllocationCallbacks* allocator, VkDevice* device) {
  auto*& link =
      link_info<VkLayerDeviceCreateInfo>(info->pNext, VK_STRUCTURE_TYPE_LOADER_DEVICE_CREATE_INFO)->u.pLayerInfo;
  next_of_device = link->pfnNextGetDeviceProcAddr;
  link = link->pNext;
  const auto create = reinterpret_cast<PFN_vkCreateDevice>(next_of_instance(instance_here, "vkCreateDevice"));
  std::vector<VkDeviceQueueCreateInfo> queues(info->pQueueCreateInfos,
                                              info->pQueueCreateInfos + info->queueCreateInfoCount);
  std::erase_if(queues, [](const VkDeviceQueueCreateInfo& queue) { return queue.queueFamilyIndex == copy_family; });
  VkDeviceCreateInfo own = *info;
  own.queueCreateInfoCount = static_cast<std::uint32_t>(queues.size());
  own.pQueueCreateInfos = queues.data();
  const VkResult result = create(physical, &own, allocator, device);
  device_here = *device;
  calls_left = plan().count;
  is_lost = false;
  return result;
}

struct Entry {
  const char* name;
  PFN_vkVoidFunction function;
};

template <typename Function>
Entry entry(const char* name, Function function) {
  return {name, reinterpret_cast<PFN_vkVoidFunction>(function)};
}

PFN_vkVoidFunction find(std::initializer_list<Entry> entries, const char* name) {
  for (const Entry& entry : entries) {
    if (std::strcmp(entry.name, name) == 0) return entry.function;
  }
  return nullptr;
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL device_function(VkDevice device, const char* name) {
  const PFN_vkVoidFunction own =
      find({entry("vkGetDeviceProcAddr", device_function), entry("vkQueueSubmit", queue_submit),
            entry("vkWaitForFences", wait_for_fences), entry("vkAcquireNextImageKHR", acquire_next_image),
            entry("vkQueuePresentKHR", queue_present), entry("vkDeviceWaitIdle", device_wait_idle),
            entry("vkGetQueryPoolResults", query_results), entry("vkCreatePipelineCache", create_pipeline_cache),
            entry("vkAllocateMemory", allocate_memory), entry("vkCreateBuffer", create_buffer),
            entry("vkAllocateDescriptorSets", allocate_sets), entry("vkGetDeviceQueue", device_queue),
            entry("vkCreateCommandPool", create_command_pool), entry("vkAllocateCommandBuffers", allocate_commands),
            entry("vkCmdCopyBuffer", copy_buffer)},
           name);
  return own ? own : next_of_device(device, name);
}

VKAPI_ATTR PFN_vkVoidFunction VKAPI_CALL instance_function(VkInstance instance, const char* name) {
  const PFN_vkVoidFunction own =
      find({entry("vkGetInstanceProcAddr", instance_function), entry("vkCreateInstance", create_instance),
            entry("vkCreateDevice", create_device), entry("vkGetDeviceProcAddr", device_function),
            entry("vkGetPhysicalDeviceQueueFamilyProperties", queue_families),
            entry("vkGetPhysicalDeviceMemoryProperties", memory_properties)},
           name);
  return own ? own : next_of_instance ? next_of_instance(instance, name) : nullptr;
}

}  // namespace

extern "C" VK_LAYER_EXPORT VKAPI_ATTR VkResult VKAPI_CALL
vkNegotiateLoaderLayerInterfaceVersion(VkNegotiateLayerInterface* version) {
  version->loaderLayerInterfaceVersion = CURRENT_LOADER_LAYER_INTERFACE_VERSION;
  version->pfnGetInstanceProcAddr = instance_function;
  version->pfnGetDeviceProcAddr = device_function;
  version->pfnGetPhysicalDeviceProcAddr = nullptr;
  return VK_SUCCESS;
}
