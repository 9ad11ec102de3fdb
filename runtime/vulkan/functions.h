// Vulkan's functions. They are looked for when a device is first asked for, so that what never does runs on a machine
// without Vulkan's loader. Here they are pointers with names of a namespace: what a host program links with, or volk's
// variables in it, have the functions' own.
#pragma once

#include <vulkan/vulkan.h>

#include <string>

// The functions that Bodyopt calls, and Dear ImGui for it.
// clang-format off
#define BODYOPT_VULKAN_FUNCTIONS(each) \
  each(vkAcquireNextImageKHR) each(vkAllocateCommandBuffers) each(vkAllocateDescriptorSets) each(vkAllocateMemory) \
  each(vkBeginCommandBuffer) each(vkBindBufferMemory) each(vkBindImageMemory) each(vkCmdBeginRenderPass) \
  each(vkCmdBindDescriptorSets) each(vkCmdBindIndexBuffer) each(vkCmdBindPipeline) each(vkCmdBindVertexBuffers) \
  each(vkCmdBlitImage) each(vkCmdCopyBuffer) each(vkCmdCopyBufferToImage) each(vkCmdCopyImageToBuffer) \
  each(vkCmdDispatch) each(vkCmdDraw) each(vkCmdDrawIndexed) each(vkCmdEndRenderPass) each(vkCmdFillBuffer) \
  each(vkCmdPipelineBarrier) each(vkCmdPushConstants) each(vkCmdResetQueryPool) each(vkCmdSetScissor) \
  each(vkCmdSetViewport) each(vkCmdUpdateBuffer) each(vkCmdWriteTimestamp) each(vkCreateBuffer) \
  each(vkCreateCommandPool) each(vkCreateComputePipelines) each(vkCreateDescriptorPool) \
  each(vkCreateDescriptorSetLayout) each(vkCreateDevice) each(vkCreateFence) each(vkCreateFramebuffer) \
  each(vkCreateGraphicsPipelines) each(vkCreateImage) each(vkCreateImageView) each(vkCreateInstance) \
  each(vkCreatePipelineCache) each(vkCreatePipelineLayout) each(vkCreateQueryPool) each(vkCreateRenderPass) \
  each(vkCreateSampler) each(vkCreateSemaphore) each(vkCreateShaderModule) each(vkCreateSwapchainKHR) \
  each(vkDestroyBuffer) each(vkDestroyCommandPool) each(vkDestroyDescriptorPool) \
  each(vkDestroyDescriptorSetLayout) each(vkDestroyDevice) each(vkDestroyFence) each(vkDestroyFramebuffer) \
  each(vkDestroyImage) each(vkDestroyImageView) each(vkDestroyInstance) each(vkDestroyPipeline) \
  each(vkDestroyPipelineCache) each(vkDestroyPipelineLayout) each(vkDestroyQueryPool) each(vkDestroyRenderPass) \
  each(vkDestroySampler) each(vkDestroySemaphore) each(vkDestroyShaderModule) each(vkDestroySurfaceKHR) \
  each(vkDestroySwapchainKHR) each(vkDeviceWaitIdle) each(vkEndCommandBuffer) \
  each(vkEnumerateDeviceExtensionProperties) each(vkEnumerateInstanceExtensionProperties) \
  each(vkEnumerateInstanceLayerProperties) each(vkEnumeratePhysicalDevices) each(vkFlushMappedMemoryRanges) \
  each(vkFreeCommandBuffers) each(vkFreeMemory) each(vkGetBufferMemoryRequirements) each(vkGetDeviceQueue) \
  each(vkGetImageMemoryRequirements) each(vkGetInstanceProcAddr) each(vkGetPhysicalDeviceMemoryProperties) \
  each(vkGetPhysicalDeviceProperties) each(vkGetPhysicalDeviceProperties2) \
  each(vkGetPhysicalDeviceQueueFamilyProperties) each(vkGetPhysicalDeviceSurfaceCapabilitiesKHR) \
  each(vkGetPhysicalDeviceSurfaceFormatsKHR) each(vkGetPhysicalDeviceSurfacePresentModesKHR) \
  each(vkGetPhysicalDeviceSurfaceSupportKHR) each(vkGetPipelineCacheData) each(vkGetQueryPoolResults) \
  each(vkGetSwapchainImagesKHR) each(vkMapMemory) each(vkQueuePresentKHR) each(vkQueueSubmit) \
  each(vkResetCommandPool) each(vkResetDescriptorPool) each(vkResetFences) each(vkUnmapMemory) \
  each(vkUpdateDescriptorSets) each(vkWaitForFences)
// clang-format on

namespace bodyopt {

// Null until vulkan::missing_functions() or vulkan::find_functions() was called. A process has those of one loader.
#define BODYOPT_DECLARE(function) extern PFN_##function function;
BODYOPT_VULKAN_FUNCTIONS(BODYOPT_DECLARE)
#undef BODYOPT_DECLARE

namespace vulkan {

// Finds the functions by the system's loader, unless they are there; from any thread. Gives why there are none on this
// machine, and what brings them; empty: they are there.
std::string missing_functions();
// Finds them by a host program's own loader, whose instance this is, unless they are there; from any thread. Throws
// Error(device) where they are those of another loader, or `find` does not have one that computing needs.
void find_functions(VkInstance instance, PFN_vkGetInstanceProcAddr find);

}  // namespace vulkan
}  // namespace bodyopt
