#include "runtime/vulkan/kernels/pose_skin.h"

#include <algorithm>
#include <array>

#include "pose_skin.spv.h"
#include "shaders/include/layout.h"

namespace bodyopt::vulkan {

PoseSkin::PoseSkin(const Device& device) : kernel_(device, pose_skin_spv, sizeof(PoseSkinPush)) {}

void PoseSkin::record(Commands& commands, const Buffers& buffers, std::uint32_t vertex_count, std::uint32_t joint_count,
                      std::uint32_t frames) const {
  const DdmBuffers& ddm = buffers.ddm;
  for (const DdmWindow& window : ddm.windows) {
    if (window.first_vertex >= vertex_count) break;
    if (&window != &ddm.windows.front()) commands.barrier();  // all windows write into one buffer
    const std::array bindings = {BufferRange(ddm.block_begin),
                                 BufferRange(ddm.block_joints),
                                 BufferRange(ddm.moments, window.moments_offset, window.moments_size),
                                 BufferRange(ddm.vertices, window.vertices_offset, window.vertices_size),
                                 buffers.skinning,
                                 buffers.origins,
                                 buffers.displacements,
                                 buffers.positions};
    const PoseSkinPush push{vertex_count, joint_count, window.first_vertex, window.end_vertex, window.first_entry};
    commands.dispatch(kernel_, bindings, push, std::min(window.end_vertex, vertex_count) - window.first_vertex, frames);
  }
}

}  // namespace bodyopt::vulkan
