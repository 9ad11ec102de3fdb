#include "runtime/vulkan/kernels/diffuse_surface.h"

#include <array>

#include "diffuse_surface.spv.h"

namespace bodyopt::vulkan {

DiffuseSurface::DiffuseSurface(const Device& device)
    : kernel_(device, diffuse_surface_spv, sizeof(DiffuseSurfacePush)) {}

void DiffuseSurface::record(Commands& commands, const Buffers& buffers, const DiffuseSurfacePush& push,
                            std::uint32_t frames) const {
  const std::array bindings = {buffers.surface, buffers.positions, buffers.origins, buffers.nodes};
  commands.dispatch(kernel_, bindings, push, push.surface_count, frames);
}

}  // namespace bodyopt::vulkan
