// vulkan.h: the host's device, command buffers and buffers.
#include "include/bodyopt/vulkan.h"

#include "runtime/library/following_outputs.h"
#include "runtime/library/guard.h"
#include "runtime/library/handles.h"
#include "runtime/library/modifier_drive.h"
#include "runtime/library/strides.h"
#include "runtime/vulkan/commands.h"

namespace bodyopt {
namespace {

constexpr VkDeviceSize kMost = VkDeviceSize{1} << 34;  // words are counted in 32 bits

// The place of `frames` frames, `frame_stride` bytes apart. Throws Error(usage) for strides that are too small or a
// buffer that does not hold all vertices.
vulkan::PlacedOutput placed_output(const bodyopt_vulkan_output& output, VkDeviceSize frame_stride, std::size_t frames,
                                   std::size_t vertices, std::size_t numbers, const std::string& name) {
  if (output.buffer == VK_NULL_HANDLE || vertices == 0) return {};
  const VkDeviceSize element = numbers * sizeof(float);
  const auto refuse = [&](const auto&... what) { throw Error(ErrorKind::usage, "'recording.", name, "' ", what...); };
  const VkDeviceSize stride = output.element_stride == 0 ? element : output.element_stride;
  if (stride < element) refuse("has an element_stride of ", stride, " bytes, at least ", element, " are needed");
  if (output.size > kMost || stride > kMost || output.offset > kMost || frame_stride > kMost) {
    refuse("is larger than can be addressed");
  }
  const VkDeviceSize frame = (vertices - 1) * stride + element;
  if (frame_stride == 0) frame_stride = frame;
  if (frame_stride < frame) refuse("has a frame stride of ", frame_stride, " bytes, at least ", frame, " are needed");
  if (stride % 4 != 0 || frame_stride % 4 != 0 || output.offset % 4 != 0) {
    refuse("has a stride or an offset that is no multiple of 4 bytes");
  }
  const VkDeviceSize needed = output.offset + (frames - 1) * frame_stride + frame;
  if (output.size < needed) refuse("has ", output.size, " bytes, ", needed, " are needed");
  return {output.buffer, output.size, output.offset, stride, frame_stride};
}

void place_attached(const bodyopt_recording& wanted, const bodyopt_instance& instance, std::size_t frames,
                    std::vector<vulkan::PlacedOutput>& placed) {
  const Attachments& attached = instance.following->attached();
  const auto outputs = attached_outputs(wanted.attached, wanted.attached_count, attached, "recording.attached");
  if (!outputs.empty() && !instance.attached) {
    throw Error(ErrorKind::usage,
                "'recording.attached' is wanted of an instance that has no memory for it: make it "
                "on a Vulkan device with 'options.recorded_frames' of 1 or more");
  }
  placed.clear();
  for (std::size_t m = 0; m < outputs.size(); ++m) {
    const VkDeviceSize stride = wanted.attached_frame_strides == nullptr ? 0 : wanted.attached_frame_strides[m];
    placed.push_back(
        placed_output(outputs[m], stride, frames, attached.meshes[m].vertex_count(), 3, concat("attached[", m, "]")));
  }
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
    const std::size_t frames = given.count();
    if (frames == 0 || frames > instance->recorded_frames) {
      throw Error(ErrorKind::usage, "'poses' has ", frames, " frames, expected 1 to ", instance->recorded_frames,
                  " (bodyopt_instance_options.recorded_frames)");
    }
    const auto wanted = read_struct(recording, BODYOPT_RECORDING_FIRST_SIZE, "recording");
    required(wanted.commands, "recording.commands");
    const std::size_t vertices = deformer.basis().mesh.output_count();
    vulkan::Recording& into = instance->recording;
    into.commands = wanted.commands;
    into.positions = placed_output(wanted.positions, wanted.positions_frame_stride, frames, vertices, 3, "positions");
    into.normals = placed_output(wanted.normals, wanted.normals_frame_stride, frames, vertices, 3, "normals");
    into.tangents = placed_output(wanted.tangents, wanted.tangents_frame_stride, frames, vertices, 4, "tangents");
    into.attached = instance->attached ? &*instance->attached : nullptr;
    place_attached(wanted, *instance, frames, into.attached_to);
    into.most_frames = instance->recorded_frames;
    given.read(0, frames, instance->poses);
    ModifierDrive drive(*instance, given);
    drive.apply(0, instance->poses);
    std::optional<std::span<const int>> numbers;
    if (deformer.dynamics() != nullptr) numbers = given.frame_numbers();
    deformer.record(instance->poses, numbers, into);
    drive.keep(*instance);
  });
}

bodyopt_result bodyopt_forget_buffers(bodyopt_instance* instance) {
  return guarded([&] { required(instance, "instance").deformer->forget_recorded_buffers(); });
}
