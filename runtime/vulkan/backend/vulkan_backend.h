// The stages on a Vulkan device.
#pragma once

#include <memory>

#include "runtime/host/backend.h"

namespace bodyopt {

namespace vulkan {
class Device;
}

// Throws Error(device) when the tables do not fit the device.
std::unique_ptr<Backend> make_vulkan_backend(const Basis& basis, std::shared_ptr<const vulkan::Device> device,
                                             const JiggleModel& jiggle = {});

}  // namespace bodyopt
