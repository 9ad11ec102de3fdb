// Dear ImGui's backend, as Debian compiles it, calls Vulkan's functions by their own names. To link it with Vulkan's
// loader would keep all of the program from machines without one: here these names are, and call what was found.
#include <tuple>

#include "runtime/vulkan/functions.h"

namespace bodyopt::viewport {
namespace {

template <typename Pointer>
struct Signature;

template <typename Returned, typename... Arguments>
struct Signature<Returned(VKAPI_PTR*)(Arguments...)> {
  using Result = Returned;
  template <std::size_t index>
  using Argument = std::tuple_element_t<index, std::tuple<Arguments...>>;
};

}  // namespace
}  // namespace bodyopt::viewport

#define BODYOPT_ARGUMENT(function, index) bodyopt::viewport::Signature<PFN_##function>::Argument<index> a##index
#define BODYOPT_ARGUMENTS_1(function) BODYOPT_ARGUMENT(function, 0)
#define BODYOPT_ARGUMENTS_2(function) BODYOPT_ARGUMENTS_1(function), BODYOPT_ARGUMENT(function, 1)
#define BODYOPT_ARGUMENTS_3(function) BODYOPT_ARGUMENTS_2(function), BODYOPT_ARGUMENT(function, 2)
#define BODYOPT_ARGUMENTS_4(function) BODYOPT_ARGUMENTS_3(function), BODYOPT_ARGUMENT(function, 3)
#define BODYOPT_ARGUMENTS_5(function) BODYOPT_ARGUMENTS_4(function), BODYOPT_ARGUMENT(function, 4)
#define BODYOPT_ARGUMENTS_6(function) BODYOPT_ARGUMENTS_5(function), BODYOPT_ARGUMENT(function, 5)
#define BODYOPT_ARGUMENTS_7(function) BODYOPT_ARGUMENTS_6(function), BODYOPT_ARGUMENT(function, 6)
#define BODYOPT_ARGUMENTS_8(function) BODYOPT_ARGUMENTS_7(function), BODYOPT_ARGUMENT(function, 7)
#define BODYOPT_ARGUMENTS_9(function) BODYOPT_ARGUMENTS_8(function), BODYOPT_ARGUMENT(function, 8)
#define BODYOPT_ARGUMENTS_10(function) BODYOPT_ARGUMENTS_9(function), BODYOPT_ARGUMENT(function, 9)
#define BODYOPT_VALUES_1 a0
#define BODYOPT_VALUES_2 BODYOPT_VALUES_1, a1
#define BODYOPT_VALUES_3 BODYOPT_VALUES_2, a2
#define BODYOPT_VALUES_4 BODYOPT_VALUES_3, a3
#define BODYOPT_VALUES_5 BODYOPT_VALUES_4, a4
#define BODYOPT_VALUES_6 BODYOPT_VALUES_5, a5
#define BODYOPT_VALUES_7 BODYOPT_VALUES_6, a6
#define BODYOPT_VALUES_8 BODYOPT_VALUES_7, a7
#define BODYOPT_VALUES_9 BODYOPT_VALUES_8, a8
#define BODYOPT_VALUES_10 BODYOPT_VALUES_9, a9
// Hidden: no library that is loaded later shall take them for the loader's.
#define BODYOPT_FORWARD(count, function)                                                                          \
  extern "C" __attribute__((visibility("hidden"))) bodyopt::viewport::Signature<PFN_##function>::Result function( \
      BODYOPT_ARGUMENTS_##count(function)) {                                                                      \
    return bodyopt::function(BODYOPT_VALUES_##count);                                                             \
  }

BODYOPT_FORWARD(3, vkAllocateCommandBuffers)
BODYOPT_FORWARD(3, vkAllocateDescriptorSets)
BODYOPT_FORWARD(4, vkAllocateMemory)
BODYOPT_FORWARD(4, vkBindBufferMemory)
BODYOPT_FORWARD(4, vkBindImageMemory)
BODYOPT_FORWARD(8, vkCmdBindDescriptorSets)
BODYOPT_FORWARD(4, vkCmdBindIndexBuffer)
BODYOPT_FORWARD(3, vkCmdBindPipeline)
BODYOPT_FORWARD(5, vkCmdBindVertexBuffers)
BODYOPT_FORWARD(6, vkCmdCopyBufferToImage)
BODYOPT_FORWARD(6, vkCmdDrawIndexed)
BODYOPT_FORWARD(10, vkCmdPipelineBarrier)
BODYOPT_FORWARD(6, vkCmdPushConstants)
BODYOPT_FORWARD(4, vkCmdSetScissor)
BODYOPT_FORWARD(4, vkCmdSetViewport)
BODYOPT_FORWARD(4, vkCreateBuffer)
BODYOPT_FORWARD(4, vkCreateCommandPool)
BODYOPT_FORWARD(4, vkCreateDescriptorSetLayout)
BODYOPT_FORWARD(4, vkCreateFence)
BODYOPT_FORWARD(4, vkCreateFramebuffer)
BODYOPT_FORWARD(6, vkCreateGraphicsPipelines)
BODYOPT_FORWARD(4, vkCreateImage)
BODYOPT_FORWARD(4, vkCreateImageView)
BODYOPT_FORWARD(4, vkCreatePipelineLayout)
BODYOPT_FORWARD(4, vkCreateRenderPass)
BODYOPT_FORWARD(4, vkCreateSampler)
BODYOPT_FORWARD(4, vkCreateSemaphore)
BODYOPT_FORWARD(4, vkCreateShaderModule)
BODYOPT_FORWARD(4, vkCreateSwapchainKHR)
BODYOPT_FORWARD(3, vkDestroyBuffer)
BODYOPT_FORWARD(3, vkDestroyCommandPool)
BODYOPT_FORWARD(3, vkDestroyDescriptorSetLayout)
BODYOPT_FORWARD(3, vkDestroyFence)
BODYOPT_FORWARD(3, vkDestroyFramebuffer)
BODYOPT_FORWARD(3, vkDestroyImage)
BODYOPT_FORWARD(3, vkDestroyImageView)
BODYOPT_FORWARD(3, vkDestroyPipeline)
BODYOPT_FORWARD(3, vkDestroyPipelineLayout)
BODYOPT_FORWARD(3, vkDestroyRenderPass)
BODYOPT_FORWARD(3, vkDestroySampler)
BODYOPT_FORWARD(3, vkDestroySemaphore)
BODYOPT_FORWARD(3, vkDestroyShaderModule)
BODYOPT_FORWARD(3, vkDestroySurfaceKHR)
BODYOPT_FORWARD(3, vkDestroySwapchainKHR)
BODYOPT_FORWARD(1, vkDeviceWaitIdle)
BODYOPT_FORWARD(3, vkFlushMappedMemoryRanges)
BODYOPT_FORWARD(4, vkFreeCommandBuffers)
BODYOPT_FORWARD(3, vkFreeMemory)
BODYOPT_FORWARD(3, vkGetBufferMemoryRequirements)
BODYOPT_FORWARD(3, vkGetImageMemoryRequirements)
BODYOPT_FORWARD(2, vkGetPhysicalDeviceMemoryProperties)
BODYOPT_FORWARD(3, vkGetPhysicalDeviceSurfaceCapabilitiesKHR)
BODYOPT_FORWARD(4, vkGetPhysicalDeviceSurfaceFormatsKHR)
BODYOPT_FORWARD(4, vkGetPhysicalDeviceSurfacePresentModesKHR)
BODYOPT_FORWARD(4, vkGetSwapchainImagesKHR)
BODYOPT_FORWARD(6, vkMapMemory)
BODYOPT_FORWARD(2, vkUnmapMemory)
BODYOPT_FORWARD(5, vkUpdateDescriptorSets)
