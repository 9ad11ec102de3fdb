#include "runtime/vulkan/kernels/strain_skin.h"

#include <algorithm>
#include <array>

#include "shaders/include/layout.h"
#include "strain_skin.spv.h"

namespace bodyopt::vulkan {

StrainSkin::StrainSkin(const Device& device) : kernel_(device, strain_skin_spv, sizeof(StrainSkinPush)) {}

void StrainSkin::record(Commands& commands, const Buffers& buffers, std::uint32_t strain_vertex_count,
                        std::uint32_t joint_count, std::uint32_t frames) const {
  const DdmBuffers& ddm = buffers.ddm;
  for (const DdmWindow& window : ddm.windows) {
    if (&window != &ddm.windows.front()) commands.barrier();  // all windows write into one buffer
    const std::array bindings = {BufferRange(ddm.block_begin),
                                 BufferRange(ddm.block_joints),
                                 BufferRange(ddm.moments, window.moments_offset, window.moments_size),
                                 BufferRange(ddm.vertices, window.vertices_offset, window.vertices_size),
                                 buffers.skinning,
                                 buffers.strain_vertices,
                                 buffers.positions};
    const StrainSkinPush push{strain_vertex_count, joint_count, window.first_vertex, window.end_vertex,
                              window.first_entry};
    commands.dispatch(kernel_, bindings, push, strain_vertex_count, frames);
  }
}

}  // namespace bodyopt::vulkan
