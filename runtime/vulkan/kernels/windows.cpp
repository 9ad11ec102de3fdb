#include "runtime/vulkan/kernels/windows.h"

namespace bodyopt::vulkan {

void record_pose_skin(Commands& commands, const PoseSkin& kernel, const PoseSkinBuffers& buffers,
                      std::uint32_t vertex_count, std::uint32_t joint_count, std::uint32_t frames) {
  const DdmBuffers& ddm = buffers.ddm;
  for (const BlockWindow& window : ddm.windows) {
    kernel.record(commands,
                  {ddm.block_begin, ddm.block_joints, ddm.moments_of(window), ddm.vertices_of(window), buffers.skinning,
                   buffers.origins, buffers.displacements, buffers.positions},
                  {vertex_count, joint_count, window.first_vertex, window.end_vertex, window.first_entry, 0}, frames);
  }
}

void record_strain_skin(Commands& commands, const StrainSkin& kernel, const StrainSkinBuffers& buffers,
                        std::uint32_t strain_vertex_count, std::uint32_t joint_count, std::uint32_t frames) {
  const DdmBuffers& ddm = buffers.ddm;
  for (const BlockWindow& window : ddm.windows) {
    kernel.record(commands,
                  {ddm.block_begin, ddm.block_joints, ddm.moments_of(window), ddm.vertices_of(window), buffers.skinning,
                   buffers.strain_vertices, buffers.positions},
                  {strain_vertex_count, joint_count, window.first_vertex, window.end_vertex, window.first_entry, 0},
                  frames);
  }
}

void record_residual_blend(Commands& commands, const ResidualBlend& kernel, const ResidualBlendBuffers& buffers,
                           std::uint32_t vertex_count, std::uint32_t coefficient_count, float weight,
                           std::uint32_t frames) {
  const BlendBuffers& blend = buffers.blend;
  for (const BlockWindow& window : blend.windows) {
    kernel.record(
        commands, {blend.block_begin, blend.entries_of(window), buffers.coefficients, buffers.displacements},
        {vertex_count, coefficient_count, weight, window.first_vertex, window.end_vertex, window.first_entry, 0},
        frames);
  }
}

void record_modify_blend(Commands& commands, const ModifyBlend& kernel, const ModifyBlendBuffers& buffers,
                         std::uint32_t vertex_count, std::uint32_t component_count, std::uint32_t frames) {
  const BlendBuffers& blend = buffers.blend;
  for (const BlockWindow& window : blend.windows) {
    kernel.record(commands, {blend.block_begin, blend.entries_of(window), buffers.coefficients, buffers.displacements},
                  {vertex_count, component_count, window.first_vertex, window.end_vertex, window.first_entry, 0},
                  frames);
  }
}

void record_output_relax(Commands& commands, const OutputRelax& kernel, const OutputRelaxBuffers& buffers,
                         OutputRelaxPush push, std::uint32_t frames) {
  const FanBuffers& fans = buffers.fans;
  for (const BlockWindow& window : fans.windows) {
    push.first_vertex = window.first_vertex;
    push.end_vertex = window.end_vertex;
    push.first_triangle = window.first_entry;
    kernel.record(
        commands,
        {fans.begin, fans.triangles_of(window), buffers.rest, buffers.weights, buffers.current, buffers.relaxed}, push,
        frames);
  }
}

void record_output_normals(Commands& commands, const OutputNormals& kernel, const OutputNormalsBuffers& buffers,
                           std::uint32_t vertex_count, std::uint32_t frames) {
  const FanBuffers& fans = buffers.fans;
  for (const BlockWindow& window : fans.windows) {
    kernel.record(commands, {fans.begin, fans.triangles_of(window), buffers.positions, buffers.normals},
                  {vertex_count, window.first_vertex, window.end_vertex, window.first_entry}, frames);
  }
}

void record_block_gather(Commands& commands, const BlockGather& kernel, const BlockGatherBuffers& buffers,
                         const InverseBuffers::LevelWindows& level, std::uint32_t right_side_count,
                         std::uint32_t interleave) {
  const InverseBuffers& inverse = buffers.inverse;
  const InverseLevel& slots = level.slots;
  kernel.record(
      commands, {inverse.slot_unknown, inverse.child_slots, buffers.right_sides, buffers.results, buffers.gathered},
      {slots.first_slot, slots.own_end, slots.end_slot, inverse.slot_count, inverse.unknown_count, interleave},
      right_side_count);
}

void record_block_up(Commands& commands, const BlockUp& kernel, const BlockUpBuffers& buffers,
                     const InverseBuffers::LevelWindows& level, std::uint32_t right_side_count) {
  const InverseBuffers& inverse = buffers.inverse;
  for (const InverseWindow& window : level.up) {
    kernel.record(commands, {inverse.up, inverse.values_of(window), buffers.gathered, buffers.results},
                  {window.first, window.count, window.first_value, level.slots.own_end, inverse.slot_count},
                  right_side_count);
  }
}

void record_block_down(Commands& commands, const BlockDown& kernel, const BlockDownBuffers& buffers,
                       const InverseBuffers::LevelWindows& level, std::uint32_t right_side_count,
                       std::uint32_t interleave) {
  const InverseBuffers& inverse = buffers.inverse;
  for (const InverseWindow& window : level.down) {
    kernel.record(
        commands,
        {inverse.down, inverse.values_of(window), inverse.slot_unknown, buffers.results, buffers.solutions,
         buffers.solutions},
        {window.first, window.count, window.first_value, inverse.slot_count, inverse.unknown_count, interleave},
        right_side_count);
  }
}

}  // namespace bodyopt::vulkan
