#include "runtime/vulkan/kernels/residual_features.h"

#include <array>

#include "residual_features.spv.h"

namespace bodyopt::vulkan {

ResidualFeatures::ResidualFeatures(const Device& device)
    : kernel_(device, residual_features_spv, sizeof(ResidualFeaturesPush)) {}

void ResidualFeatures::record(Commands& commands, const Buffers& buffers, const ResidualFeaturesPush& push,
                              std::uint32_t frames) const {
  const std::array bindings = {buffers.ranges,   buffers.joint_features, buffers.strains,
                               buffers.controls, buffers.features,       buffers.excess};
  commands.dispatch(kernel_, bindings, push, push.joint_feature_count + push.strain_count + push.control_count, frames);
}

}  // namespace bodyopt::vulkan
