#include "runtime/vulkan/kernels/jiggle_stress.h"

#include <array>

#include "jiggle_stress.spv.h"

namespace bodyopt::vulkan {

JiggleStress::JiggleStress(const Device& device) : kernel_(device, jiggle_stress_spv, sizeof(JiggleStressPush)) {}

void JiggleStress::record(Commands& commands, const Buffers& buffers, const JiggleStressPush& push) const {
  const std::array bindings = {buffers.tets,          buffers.shapes,    buffers.elasticity, buffers.rotations,
                               buffers.tet_rotations, buffers.direction, buffers.tractions};
  commands.dispatch(kernel_, bindings, push, push.tet_count, 1);
}

}  // namespace bodyopt::vulkan
