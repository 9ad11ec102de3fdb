#include "runtime/vulkan/kernels/output_normals.h"

#include <array>

#include "output_normals.spv.h"

namespace bodyopt::vulkan {

OutputNormals::OutputNormals(const Device& device) : kernel_(device, output_normals_spv, sizeof(OutputNormalsPush)) {}

void OutputNormals::record(Commands& commands, const Buffers& buffers, const OutputNormalsPush& push,
                           std::uint32_t frames) const {
  const std::array bindings = {buffers.triangles, buffers.vertex_triangle_begin, buffers.vertex_triangles,
                               buffers.positions, buffers.normals};
  commands.dispatch(kernel_, bindings, push, push.vertex_count, frames);
}

}  // namespace bodyopt::vulkan
