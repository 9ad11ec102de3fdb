// The CPU's kernels for a skin that a device draws: a software device draws well, and runs kernels many times slower.
#pragma once

#include <cstdint>
#include <memory>

#include "runtime/host/backend.h"

namespace bodyopt {

// Runs `cpu`, and keeps the skin of the last batch where the device, which must be a software one, draws it.
// `skin_bytes`: of a frame's positions.
std::unique_ptr<Backend> make_drawn_backend(std::unique_ptr<Backend> cpu, std::shared_ptr<const vulkan::Device> device,
                                            std::uint64_t skin_bytes);

}  // namespace bodyopt
