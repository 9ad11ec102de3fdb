// vulkan.h: the host's device, command buffers and buffers.
#include "include/bodyopt/vulkan.h"

#include "runtime/library/guard.h"
#include "runtime/library/handles.h"
#include "runtime/library/modifier_drive.h"
#include "runtime/library/strides.h"
#include "runtime/vulkan/commands.h"

namespace bodyopt {
namespace {

// Throws Error(usage) for strides that are too small or a buffer that does not hold all vertices.
vulkan::PlacedOutput placed_output(const bodyopt_vulkan_output& output, std::size_t vertices, std::size_t numbers,
                                   const char* name) {
  if (output.buffer == VK_NULL_HANDLE || vertices == 0) return {};
  constexpr VkDeviceSize kMost = VkDeviceSize{1} << 34;  // words are counted in 32 bits
  const VkDeviceSize element = numbers * sizeof(float);
  const auto refuse = [&](const auto&... what) { throw Error(ErrorKind::usage, "'recording.", name, "' ", what...); };
  const VkDeviceSize stride = output.element_stride == 0 ? element : output.element_stride;
  if (stride < element) refuse("has an element_stride of ", stride, " bytes, at least ", element, " are needed");
  if (stride % 4 != 0 || output.offset % 4 != 0) refuse("has a stride or an offset that is no multiple of 4 bytes");
  if (output.size > kMost || stride > kMost || output.offset > kMost) refuse("is larger than can be addressed");
  const VkDeviceSize needed = output.offset + (vertices - 1) * stride + element;
  if (output.size < needed) refuse("has ", output.size, " bytes, ", needed, " are needed");
  return {output.buffer, output.size, output.offset, stride};
}

}  // namespace
}  // namespace bodyopt

using namespace bodyopt;

bodyopt_result bodyopt_share_device(const bodyopt_vulkan_device* host, bodyopt_device** device) {
  return guarded([&] {
    required(device, "device");
    const auto given = read_struct(host, BODYOPT_VULKAN_DEVICE_FIRST_SIZE, "host");
    *device = new bodyopt_device{std::make_shared<const vulkan::Device>(
        vulkan::HostDevice{given.instance, given.physical_device, given.device, given.queue, given.queue_family,
                           given.pipeline_cache, given.get_instance_proc_addr})};
  });
}

bodyopt_result bodyopt_record(bodyopt_instance* instance, const bodyopt_poses* poses,
                              const bodyopt_recording* recording) {
  return guarded([&] {
    Deformer& deformer = *required(instance, "instance").deformer;
    const GivenPoses given(poses, deformer.basis(), instance->channels);
    if (given.count() != 1) {
      throw Error(ErrorKind::usage, "'poses' has ", given.count(), " frames; a recording is of one");
    }
    const auto wanted = read_struct(recording, BODYOPT_RECORDING_FIRST_SIZE, "recording");
    required(wanted.commands, "recording.commands");
    const std::size_t vertices = deformer.basis().mesh.output_count();
    const vulkan::Recording into{wanted.commands, placed_output(wanted.positions, vertices, 3, "positions"),
                                 placed_output(wanted.normals, vertices, 3, "normals"),
                                 placed_output(wanted.tangents, vertices, 4, "tangents")};
    std::vector<Pose> pose = given.read(0, 1);
    ModifierDrive drive(*instance, given);
    drive.apply(0, pose);
    std::optional<int> frame;
    if (deformer.dynamics() != nullptr) frame = given.frame_numbers().front();
    deformer.record(pose.front(), frame, into);
    drive.keep(*instance);
  });
}

bodyopt_result bodyopt_forget_buffers(bodyopt_instance* instance) {
  return guarded([&] { required(instance, "instance").deformer->forget_recorded_buffers(); });
}
