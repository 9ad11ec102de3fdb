// What any engine has: a Vulkan device with a queue, a command buffer, and buffers, here ones that the CPU reads and
// writes.
#pragma once

#include <bodyopt/vulkan.h>

#include <bodyopt/bodyopt.hpp>
#include <cstdint>
#include <stdexcept>
#include <string>

inline void require(VkResult result) {
  if (result != VK_SUCCESS) throw std::runtime_error("Vulkan failed: " + std::to_string(result));
}

class Engine {
 public:
  VkInstance instance{};
  VkPhysicalDevice physical{};
  VkDevice device{};
  VkQueue queue{};
  VkCommandPool pool{};
  VkCommandBuffer commands{};

  Engine() {
    const VkApplicationInfo application{
        VK_STRUCTURE_TYPE_APPLICATION_INFO, nullptr, "engine", 1, nullptr, 0, VK_API_VERSION_1_2};
    const VkInstanceCreateInfo instance_info{VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO, nullptr, 0, &application};
    require(vkCreateInstance(&instance_info, nullptr, &instance));
    std::uint32_t count = 1;
    vkEnumeratePhysicalDevices(instance, &count, &physical);
    if (count == 0) throw std::runtime_error("no Vulkan device");
    const float priority = 1;
    const VkDeviceQueueCreateInfo queue_info{VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO, nullptr, 0, 0, 1, &priority};
    const VkDeviceCreateInfo device_info{VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO, nullptr, 0, 1, &queue_info};
    require(vkCreateDevice(physical, &device_info, nullptr, &device));
    vkGetDeviceQueue(device, 0, 0, &queue);
    const VkCommandPoolCreateInfo pool_info{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO, nullptr,
                                            VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT, 0};
    require(vkCreateCommandPool(device, &pool_info, nullptr, &pool));
    const VkCommandBufferAllocateInfo commands_info{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO, nullptr, pool,
                                                    VK_COMMAND_BUFFER_LEVEL_PRIMARY, 1};
    require(vkAllocateCommandBuffers(device, &commands_info, &commands));
  }
  Engine(const Engine&) = delete;
  ~Engine() {
    vkDestroyCommandPool(device, pool, nullptr);
    vkDestroyDevice(device, nullptr);
    vkDestroyInstance(instance, nullptr);
  }

  // As Bodyopt knows it.
  bodyopt::api::Device share() const {
    auto host = bodyopt::api::make<bodyopt_vulkan_device>();
    host.instance = instance;
    host.physical_device = physical;
    host.device = device;
    host.queue = queue;
    bodyopt_device* shared = nullptr;
    bodyopt::api::check(bodyopt_share_device(&host, &shared));
    return bodyopt::api::Device(shared);
  }

  VkDeviceMemory allocate(const VkMemoryRequirements& needs, VkMemoryPropertyFlags wanted) const {
    VkPhysicalDeviceMemoryProperties types;
    vkGetPhysicalDeviceMemoryProperties(physical, &types);
    std::uint32_t type = 0;
    while (!(needs.memoryTypeBits >> type & 1) || (types.memoryTypes[type].propertyFlags & wanted) != wanted) ++type;
    const VkMemoryAllocateInfo allocation{VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, nullptr, needs.size, type};
    VkDeviceMemory memory{};
    require(vkAllocateMemory(device, &allocation, nullptr, &memory));
    return memory;
  }

  void begin() const {
    const VkCommandBufferBeginInfo info{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    require(vkBeginCommandBuffer(commands, &info));
  }

  // Waits, and the CPU sees what the stages wrote.
  void submit(VkPipelineStageFlags stages, VkAccessFlags writes) const {
    const VkMemoryBarrier barrier{VK_STRUCTURE_TYPE_MEMORY_BARRIER, nullptr, writes, VK_ACCESS_HOST_READ_BIT};
    vkCmdPipelineBarrier(commands, stages, VK_PIPELINE_STAGE_HOST_BIT, 0, 1, &barrier, 0, nullptr, 0, nullptr);
    require(vkEndCommandBuffer(commands));
    VkSubmitInfo info{VK_STRUCTURE_TYPE_SUBMIT_INFO};
    info.commandBufferCount = 1;
    info.pCommandBuffers = &commands;
    require(vkQueueSubmit(queue, 1, &info, VK_NULL_HANDLE));
    require(vkQueueWaitIdle(queue));
  }
};

class Buffer {
 public:
  Buffer(const Engine& engine, VkDeviceSize bytes, VkBufferUsageFlags usage) : size(bytes), device_(engine.device) {
    const VkBufferCreateInfo info{VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, nullptr, 0, bytes, usage};
    require(vkCreateBuffer(device_, &info, nullptr, &handle));
    VkMemoryRequirements needs;
    vkGetBufferMemoryRequirements(device_, handle, &needs);
    memory_ = engine.allocate(needs, VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT);
    require(vkBindBufferMemory(device_, handle, memory_, 0));
    require(vkMapMemory(device_, memory_, 0, VK_WHOLE_SIZE, 0, &mapped));
  }
  Buffer(const Buffer&) = delete;
  ~Buffer() {
    vkDestroyBuffer(device_, handle, nullptr);
    vkFreeMemory(device_, memory_, nullptr);
  }

  VkBuffer handle{};
  VkDeviceSize size;
  void* mapped = nullptr;

 private:
  VkDevice device_;
  VkDeviceMemory memory_{};
};
