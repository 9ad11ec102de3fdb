// A kernel by its shader. When CMake configures, cmake/Kernel.cmake reads bindings, push constants and the number of
// threads from shaders/kernels/<name>.comp. It writes one ShaderKernel for each to kernels.h in the build folder:
// PoseSkin for pose_skin.comp.
#pragma once

#include <optional>

#include "runtime/vulkan/commands.h"
#include "shaders/include/layout.h"

namespace bodyopt::vulkan {

// `Shader` has Buffers (a BufferRange for each binding, by its name in the shader), Push, threads(push), spirv() and
// ranges(buffers). Its `written` has a bit for each binding that is written. With takes_frames, an invocation takes
// kFrames frames from push.first_frame on; kFrames is a constant of the shader.
template <typename Shader>
class ShaderKernel {
 public:
  using Buffers = typename Shader::Buffers;
  using Push = typename Shader::Push;

  // Throws Error(device).
  explicit ShaderKernel(const Device& device) : kernel_(device, Shader::spirv(), Shader::written, sizeof(Push)) {
    if constexpr (Shader::takes_frames) {
      together_.emplace(device, Shader::spirv(), Shader::written, sizeof(Push), kFramesTogether);
    }
  }

  // push.first_frame is set here.
  void record(Commands& commands, const Buffers& buffers, Push push, std::uint32_t frames = 1) const {
    if constexpr (Shader::takes_frames) {
      const std::uint32_t groups = frames / kFramesTogether;
      push.first_frame = 0;
      commands.dispatch(*together_, Shader::ranges(buffers), push, Shader::threads(push), groups);
      push.first_frame = groups * kFramesTogether;
      frames -= push.first_frame;
    }
    commands.dispatch(kernel_, Shader::ranges(buffers), push, Shader::threads(push), frames);
  }

 private:
  Kernel kernel_;
  std::optional<Kernel> together_;  // of kFramesTogether
};

}  // namespace bodyopt::vulkan
