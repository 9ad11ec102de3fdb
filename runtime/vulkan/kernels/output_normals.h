// Vulkan output_normals: normals of the posed skin (shaders/kernels/output_normals.comp).
#pragma once

#include "runtime/vulkan/commands.h"
#include "shaders/include/layout.h"

namespace bodyopt::vulkan {

class OutputNormals {
 public:
  struct Buffers {
    BufferRange triangles, vertex_triangle_begin, vertex_triangles, positions, normals;
  };

  explicit OutputNormals(const Device& device);
  void record(Commands& commands, const Buffers& buffers, const OutputNormalsPush& push, std::uint32_t frames) const;

 private:
  Kernel kernel_;
};

}  // namespace bodyopt::vulkan
