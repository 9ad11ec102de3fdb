// Vulkan pose_skin: the posed skin (shaders/kernels/pose_skin.comp).
#pragma once

#include "runtime/vulkan/kernels/ddm_buffers.h"

namespace bodyopt::vulkan {

class PoseSkin {
 public:
  struct Buffers {
    const DdmBuffers& ddm;
    BufferRange skinning, origins, displacements, positions;
  };

  explicit PoseSkin(const Device& device);
  // One dispatch per window of the DDM table.
  void record(Commands& commands, const Buffers& buffers, std::uint32_t vertex_count, std::uint32_t joint_count,
              std::uint32_t frames) const;

 private:
  Kernel kernel_;
};

}  // namespace bodyopt::vulkan
