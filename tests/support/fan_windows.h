// Kernels that read the triangles around vertices through windows.
#pragma once

#include "runtime/vulkan/kernels/block_buffers.h"
#include "tests/support/kernel_cases.h"
#include "tests/support/small_windows.h"

namespace bodyopt::testing {

// `c`: a case of 1,237 vertices, whose on(kernels, limits) is its run on such a device.
template <typename Case>
void expect_same_bits_through_windows_of_fans(const vulkan::Device& device, const Case& c) {
  KernelSet kernels(device);
  expect_same_bits_through_windows(
      device.info(), 1237, {8000, 20000},
      [&](const auto& limits) { return vulkan::upload_together<vulkan::FanBuffers>(device, c.mesh, limits).windows; },
      [&](const auto& limits) { return outputs_of(device, c.on(kernels, limits))[0]; });
}

}  // namespace bodyopt::testing
