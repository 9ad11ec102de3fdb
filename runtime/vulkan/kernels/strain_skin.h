// Vulkan strain_skin: DDM base positions of the vertices under fibres (shaders/kernels/strain_skin.comp).
#pragma once

#include "runtime/vulkan/kernels/ddm_buffers.h"

namespace bodyopt::vulkan {

class StrainSkin {
 public:
  struct Buffers {
    const DdmBuffers& ddm;
    BufferRange skinning, strain_vertices, positions;
  };

  explicit StrainSkin(const Device& device);
  // One dispatch per window of the DDM table.
  void record(Commands& commands, const Buffers& buffers, std::uint32_t strain_vertex_count, std::uint32_t joint_count,
              std::uint32_t frames) const;

 private:
  Kernel kernel_;
};

}  // namespace bodyopt::vulkan
