#include "tests/support/gpu_fixture.h"

#include <stdlib.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <filesystem>

namespace bodyopt::testing {

DeviceChoice test_device() {
  DeviceChoice choice;
  choice.require_device = true;
  choice.validation = true;
  if (const char* name = std::getenv("BODYOPT_TEST_DEVICE")) {
    choice.name = name;
    return choice;
  }
  const std::filesystem::path drivers = "/usr/share/vulkan/icd.d";
  if (!std::filesystem::is_directory(drivers)) return choice;
  for (const auto& entry : std::filesystem::directory_iterator(drivers)) {
    if (entry.path().filename().string().rfind("lvp_icd", 0) != 0) continue;
    setenv("VK_DRIVER_FILES", entry.path().c_str(), 1);
    setenv("VK_ICD_FILENAMES", entry.path().c_str(), 1);  // older loaders
    choice.name = "0";                                    // by name: otherwise a software device only draws
  }
  return choice;
}

std::shared_ptr<const vulkan::Device> open_test_device() {
  static const auto device = std::make_shared<const vulkan::Device>(test_device());
  return device;
}

void GpuTest::SetUpTestSuite() { device_ = std::make_unique<vulkan::Device>(test_device()); }

void GpuTest::TearDownTestSuite() {
  if (!device_) return;
  const auto log = device_->validation_log();
  device_.reset();
  EXPECT_EQ(log->messages(), std::vector<std::string>());
}

void GpuTest::TearDown() { EXPECT_EQ(device_->validation_messages(), std::vector<std::string>()); }

std::vector<std::vector<float>> run_kernel(const vulkan::Device& device, const std::vector<std::size_t>& counts,
                                           const Record& record) {
  static std::uint32_t calls = 0;
  const std::uint32_t unwritten = 0x7fe00001 + calls++ % 0xfffff;  // a NaN that no earlier call left in memory
  constexpr std::size_t kGuard = 64;                               // words before and after
  std::vector<vulkan::Buffer> buffers, readback;
  std::vector<vulkan::BufferRange> outputs;
  for (const std::size_t count : counts) {
    const std::size_t bytes = 4 * (count + 2 * kGuard);
    buffers.emplace_back(device, bytes, vulkan::Memory::device, "output");
    readback.emplace_back(device, bytes, vulkan::Memory::staging, "readback");
    outputs.emplace_back(buffers.back(), 4 * kGuard, std::max<std::size_t>(16, 4 * count));
  }
  vulkan::Commands commands(device);
  commands.begin();
  for (const vulkan::Buffer& buffer : buffers) commands.fill(buffer, unwritten);
  record(commands, outputs);
  for (std::size_t o = 0; o < counts.size(); ++o) commands.copy(buffers[o], readback[o]);
  commands.end();

  std::vector<std::vector<float>> results[2];
  for (auto& result : results) {
    commands.run();
    for (std::size_t o = 0; o < counts.size(); ++o) {
      std::vector<std::uint32_t> words(counts[o] + 2 * kGuard);
      std::memcpy(words.data(), readback[o].mapped(), 4 * words.size());
      for (std::size_t w = 0; w < words.size(); ++w) {
        const bool inside = kGuard <= w && w < kGuard + counts[o];
        if (inside != (words[w] != unwritten)) {
          ADD_FAILURE() << "output " << o << ", word " << w << " - " << kGuard << " of " << counts[o]
                        << (inside ? " was not written" : " is outside and was written");
          break;
        }
      }
      std::vector<float> values(counts[o]);
      if (!values.empty()) std::memcpy(values.data(), words.data() + kGuard, 4 * counts[o]);
      result.push_back(values);
    }
  }
  for (std::size_t o = 0; o < counts.size(); ++o) {
    EXPECT_TRUE(std::ranges::equal(results[0][o], results[1][o], {}, std::bit_cast<std::uint32_t, float>,
                                   std::bit_cast<std::uint32_t, float>))
        << "output " << o << " differs between two runs";
  }
  return results[0];
}

void expect_close(const std::vector<float>& actual, const std::vector<float>& expected, double absolute,
                  double relative) {
  ASSERT_EQ(actual.size(), expected.size());
  for (std::size_t i = 0; i < actual.size(); ++i) {
    const double bound = absolute + relative * std::abs(static_cast<double>(expected[i]));
    const double error = std::abs(static_cast<double>(actual[i]) - static_cast<double>(expected[i]));
    ASSERT_TRUE(error <= bound) << "at " << i << ": " << actual[i] << ", expected " << expected[i];  // also for NaN
  }
}

}  // namespace bodyopt::testing
