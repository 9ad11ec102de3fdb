// A kernel by its shader: what it binds, what it is pushed and over how many threads it runs is read from
// shaders/kernels/<name>.comp when CMake configures (cmake/Kernel.cmake), and written to kernels.h in the build folder
// as one ShaderKernel for each: PoseSkin for pose_skin.comp.
#pragma once

#include "runtime/vulkan/commands.h"

namespace bodyopt::vulkan {

// `Shader`: Buffers (a BufferRange for each binding, by its name in the shader), Push, threads(push), ranges(buffers),
// written (a bit for each binding that is written) and spirv().
template <typename Shader>
class ShaderKernel {
 public:
  using Buffers = typename Shader::Buffers;
  using Push = typename Shader::Push;

  // Throws Error(device).
  explicit ShaderKernel(const Device& device) : kernel_(device, Shader::spirv(), Shader::written, sizeof(Push)) {}

  void record(Commands& commands, const Buffers& buffers, const Push& push, std::uint32_t frames = 1) const {
    commands.dispatch(kernel_, Shader::ranges(buffers), push, Shader::threads(push), frames);
  }

 private:
  Kernel kernel_;
};

}  // namespace bodyopt::vulkan
