/* Bodyopt on the host program's own Vulkan device: the skin is recorded into the host's command buffers and written to
 * the host's buffers. Nothing is copied to the CPU and nothing waits. See bodyopt.h for what holds everywhere.
 *
 * The library calls the loader that the system finds as libvulkan.so.1. A host whose own loader is linked into it or
 * lies under another path gives that one's vkGetInstanceProcAddr: its handles must be of the loader that is called. A
 * process has one loader: the first device that is listed, opened or shared decides, and a device of another is
 * refused. The library needs Vulkan 1.2, no extension and no feature, and the queue given must compute.
 *
 * Threads: calls that load tables or evaluate on the CPU's behalf submit to the queue given. They are
 * bodyopt_create_instance, bodyopt_evaluate, bodyopt_jiggle, bodyopt_evaluate_together, bodyopt_set_state and
 * bodyopt_get_state: meanwhile the host must not use it from another thread. bodyopt_record submits nothing.
 */
#ifndef BODYOPT_VULKAN_H
#define BODYOPT_VULKAN_H

#include <vulkan/vulkan.h>

#include "bodyopt.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct bodyopt_vulkan_device {
  size_t struct_size;
  VkInstance instance;
  VkPhysicalDevice physical_device;
  VkDevice device;
  VkQueue queue;
  uint32_t queue_family;
  VkPipelineCache pipeline_cache; /* of the host, which keeps it; internally synchronized; VK_NULL_HANDLE: none */
  PFN_vkGetInstanceProcAddr get_instance_proc_addr; /* of the loader that the handles are of; NULL: libvulkan.so.1 */
} bodyopt_vulkan_device;
#define BODYOPT_VULKAN_DEVICE_FIRST_SIZE 48u

/* A device of the host, which must outlive it and all instances on it. Gives BODYOPT_DEVICE where the device or the
 * loader is not fit. */
BODYOPT_API bodyopt_result bodyopt_share_device(const bodyopt_vulkan_device* host, bodyopt_device** device);

/* The place of three numbers of each vertex (four of a tangent), from `offset` on, in the vertex order of the
 * character's file. */
typedef struct bodyopt_vulkan_output {
  VkBuffer buffer;             /* with VK_BUFFER_USAGE_STORAGE_BUFFER_BIT; VK_NULL_HANDLE: not wanted */
  VkDeviceSize size;           /* of the whole buffer, bytes */
  VkDeviceSize offset;         /* bytes, a multiple of 4 */
  VkDeviceSize element_stride; /* bytes, a multiple of 4; 0: without gaps */
} bodyopt_vulkan_output;

typedef struct bodyopt_recording {
  size_t struct_size;
  VkCommandBuffer commands; /* in the recording state, outside of a render pass, of the device's queue family */
  bodyopt_vulkan_output positions, normals;
  bodyopt_vulkan_output tangents; /* as bodyopt_skin.tangents */
  /* Bytes from one frame to the next, multiples of 4; 0: without gaps. */
  VkDeviceSize positions_frame_stride, normals_frame_stride, tangents_frame_stride;
  /* An output for each attached mesh, three numbers a vertex, of an instance that was made with recorded_frames. They
   * are in single precision: tests hold them to within 0.002 mm of what bodyopt_evaluate has near the origin, and to
   * 0.02 mm 100 m away. */
  const bodyopt_vulkan_output* attached;
  uint32_t attached_count;                    /* that of the model; 0: none is wanted */
  const VkDeviceSize* attached_frame_strides; /* of each of them, as above; NULL: without gaps */
} bodyopt_recording;
#define BODYOPT_RECORDING_FIRST_SIZE 80u

/* Records frames, at most bodyopt_instance_options.recorded_frames. They jiggle where the instance was made for it, and
 * go on with frame_numbers; else they are quasi-static. Instances may record into one command buffer, one after the
 * other. The kernels write by VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT with VK_ACCESS_SHADER_WRITE_BIT. The host sets the
 * barriers between that and its own use of the buffers, before and after. Everything recorded must be submitted once,
 * in the order of recording, to the device's queue; frames need not have run before the next is recorded. From the
 * first call on the instance records only: bodyopt_evaluate and bodyopt_jiggle are refused. Before the instance is
 * released, or its state is read or set, all that was recorded must have run. Where it fails, `commands` holds a part
 * of the frame and must not be submitted. */
BODYOPT_API bodyopt_result bodyopt_record(bodyopt_instance* instance, const bodyopt_poses* poses,
                                          const bodyopt_recording* recording);
/* An instance keeps descriptors of the buffers that it recorded for. Call this before such a buffer is destroyed, when
 * all that was recorded has run. */
BODYOPT_API bodyopt_result bodyopt_forget_buffers(bodyopt_instance* instance);

#ifdef __cplusplus
}
#endif
#endif
