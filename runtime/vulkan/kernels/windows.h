// Kernels that read a table which may be larger than one binding: one dispatch for each window of it.
#pragma once

#include "runtime/vulkan/kernels/block_buffers.h"
#include "runtime/vulkan/kernels/kernels.h"

namespace bodyopt::vulkan {

struct PoseSkinBuffers {
  const DdmBuffers& ddm;
  BufferRange skinning, origins, displacements, positions;
};
void record_pose_skin(Commands& commands, const PoseSkin& kernel, const PoseSkinBuffers& buffers,
                      std::uint32_t vertex_count, std::uint32_t joint_count, std::uint32_t frames);

struct StrainSkinBuffers {
  const DdmBuffers& ddm;
  BufferRange skinning, strain_vertices, positions;
};
void record_strain_skin(Commands& commands, const StrainSkin& kernel, const StrainSkinBuffers& buffers,
                        std::uint32_t strain_vertex_count, std::uint32_t joint_count, std::uint32_t frames);

struct ResidualBlendBuffers {
  const BlendBuffers& blend;
  BufferRange coefficients, displacements;
};
void record_residual_blend(Commands& commands, const ResidualBlend& kernel, const ResidualBlendBuffers& buffers,
                           std::uint32_t vertex_count, std::uint32_t coefficient_count, float weight,
                           std::uint32_t frames);

struct ModifyBlendBuffers {
  const BlendBuffers& blend;
  BufferRange coefficients, displacements;
};
void record_modify_blend(Commands& commands, const ModifyBlend& kernel, const ModifyBlendBuffers& buffers,
                         std::uint32_t vertex_count, std::uint32_t component_count, std::uint32_t frames);

struct OutputRelaxBuffers {
  const FanBuffers& fans;
  BufferRange rest, weights, current, relaxed;
};
// `push`: without the window.
void record_output_relax(Commands& commands, const OutputRelax& kernel, const OutputRelaxBuffers& buffers,
                         OutputRelaxPush push, std::uint32_t frames);

struct OutputNormalsBuffers {
  const FanBuffers& fans;
  BufferRange positions, normals;
};
void record_output_normals(Commands& commands, const OutputNormals& kernel, const OutputNormalsBuffers& buffers,
                           std::uint32_t vertex_count, std::uint32_t frames);

// One level of a block inverse.
struct BlockGatherBuffers {
  const InverseBuffers& inverse;
  BufferRange right_sides, results, gathered;
};
void record_block_gather(Commands& commands, const BlockGather& kernel, const BlockGatherBuffers& buffers,
                         const InverseBuffers::LevelWindows& level, std::uint32_t right_side_count,
                         std::uint32_t interleave);

struct BlockUpBuffers {
  const InverseBuffers& inverse;
  BufferRange gathered, results;
};
void record_block_up(Commands& commands, const BlockUp& kernel, const BlockUpBuffers& buffers,
                     const InverseBuffers::LevelWindows& level, std::uint32_t right_side_count);

struct BlockDownBuffers {
  const InverseBuffers& inverse;
  BufferRange results, solutions;
};
void record_block_down(Commands& commands, const BlockDown& kernel, const BlockDownBuffers& buffers,
                       const InverseBuffers::LevelWindows& level, std::uint32_t right_side_count,
                       std::uint32_t interleave);

}  // namespace bodyopt::vulkan
