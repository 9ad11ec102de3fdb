// Devices whose bindings see little: tables by blocks of vertices are seen through windows, of unaligned entries too.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "runtime/vulkan/kernels/block_buffers.h"
#include "tests/support/gpu_fixture.h"

namespace bodyopt::testing {

// `windows_of` and `run`: the windows over a table of `vertices`, and what a kernel gives through them, for a device of
// these limits. `ranges`: bytes that hold parts of the table; 400 must be less than one block of it.
void expect_same_bits_through_windows(
    const vulkan::DeviceInfo& device, std::uint32_t vertices, const std::vector<std::uint64_t>& ranges,
    const std::function<std::vector<vulkan::BlockWindow>(const vulkan::DeviceInfo&)>& windows_of,
    const std::function<std::vector<float>(const vulkan::DeviceInfo&)>& run);

}  // namespace bodyopt::testing
