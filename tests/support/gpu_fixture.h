// Kernel tests on a Vulkan device: lavapipe, unless BODYOPT_TEST_DEVICE names another; always under validation.
#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "runtime/host/device_choice.h"
#include "runtime/vulkan/commands.h"

namespace bodyopt::testing {

// What a test opens. Unless BODYOPT_TEST_DEVICE is set, makes the loader of this process see lavapipe only.
DeviceChoice test_device();

// One for all tests of this process, which share what it compiles.
std::shared_ptr<const vulkan::Device> open_test_device();

class GpuTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite();
  static void TearDownTestSuite();
  void TearDown() override;  // expects that validation had nothing to say

  static inline std::unique_ptr<vulkan::Device> device_;
};

using Record = std::function<void(vulkan::Commands&, const std::vector<vulkan::BufferRange>& outputs)>;

// Runs what `record` records twice, into outputs of `counts` floats. Expects that every value is written, that nothing
// beside the outputs is, and that both runs give the same bits. Returns the outputs.
std::vector<std::vector<float>> run_kernel(const vulkan::Device& device, const std::vector<std::size_t>& counts,
                                           const Record& record);

// Every value within absolute + relative |expected|.
void expect_close(const std::vector<float>& actual, const std::vector<float>& expected, double absolute,
                  double relative = 0);

}  // namespace bodyopt::testing
