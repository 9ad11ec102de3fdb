// The stages on a Vulkan device.
#pragma once

#include <memory>
#include <optional>

#include "runtime/host/backend.h"

namespace bodyopt {

namespace vulkan {
class DeviceModel;
}

// An instance of a model: its buffers and its state. `jiggle`: none, or the model must have dynamics. Throws
// Error(device).
std::unique_ptr<Backend> make_vulkan_backend(std::shared_ptr<const vulkan::DeviceModel> model,
                                             const std::optional<JiggleOptions>& jiggle = std::nullopt);

}  // namespace bodyopt
