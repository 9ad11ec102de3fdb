#include "runtime/vulkan/device.h"

#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <string>

#include "runtime/core/error.h"
#include "runtime/deformer/deformer.h"
#include "runtime/vulkan/kernels/windows.h"
#include "tests/support/environment.h"
#include "tests/support/gpu_fixture.h"
#include "tests/support/random_tables.h"

namespace bodyopt::testing {
namespace {

using vulkan::DeviceInfo;

DeviceInfo info(std::uint32_t index, const char* name, const char* type, const char* problem = "") {
  DeviceInfo device;
  device.index = index;
  device.name = name;
  device.type = type;
  device.problem = problem;
  return device;
}

const std::vector<DeviceInfo> kDevices = {info(0, "llvmpipe (LLVM 15)", "cpu"),
                                          info(1, "Intel(R) UHD Graphics", "integrated"),
                                          info(2, "Old Card", "discrete", "needs Vulkan 1.2 or newer"),
                                          info(3, "NVIDIA RTX A", "discrete"), info(4, "NVIDIA RTX B", "discrete")};

std::string message_of(const std::vector<DeviceInfo>& devices, const std::string& name) {
  try {
    vulkan::choose_device(devices, name);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::device);
    return error.what();
  }
  return "";
}

TEST(ChooseDevice, AutoPrefersDiscreteThenIntegratedThenSoftware) {
  EXPECT_EQ(vulkan::choose_device(kDevices, "auto"), 3u);
  EXPECT_EQ(vulkan::choose_device({kDevices[0], kDevices[1]}, "auto"), 1u);
  EXPECT_EQ(vulkan::choose_device({kDevices[0]}, "auto"), 0u);
}

TEST(ChooseDevice, TakesAnIndexOrPartOfAName) {
  EXPECT_EQ(vulkan::choose_device(kDevices, "1"), 1u);
  EXPECT_EQ(vulkan::choose_device(kDevices, "LLVM"), 0u);
  EXPECT_EQ(vulkan::choose_device(kDevices, "nvidia"), 3u);
  EXPECT_EQ(vulkan::choose_device(kDevices, "rtx b"), 4u);
}

TEST(ChooseDevice, ErrorsNameWhatExists) {
  for (const char* name : {"5", "Radeon", "", "99999999999999999999", "-1"}) {
    const std::string message = message_of(kDevices, name);
    EXPECT_NE(message.find("[3] NVIDIA RTX A (discrete)"), std::string::npos) << message;
  }
  EXPECT_NE(message_of(kDevices, "old").find("needs Vulkan 1.2"), std::string::npos);
  EXPECT_NE(message_of({}, "auto").find("mesa-vulkan-drivers"), std::string::npos);
  EXPECT_NE(message_of({kDevices[2]}, "auto").find("Old Card"), std::string::npos);
}

TEST(CheckResult, NamesCallAndResult) {
  EXPECT_NO_THROW(vulkan::check(VK_SUCCESS, "vkQueueSubmit"));
  try {
    vulkan::check(VK_ERROR_INITIALIZATION_FAILED, "vkCreateShaderModule");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::device);
    EXPECT_STREQ(error.what(), "Vulkan: vkCreateShaderModule failed: initialization failed (VkResult -3)");
  }
}

void expect_said(VkResult result, std::initializer_list<const char*> all) {
  try {
    vulkan::check(result, "vkQueueSubmit");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::device);
    const std::string text = error.what();
    for (const char* said : all) EXPECT_NE(text.find(said), std::string::npos) << said << " is not in: " << text;
  }
}

TEST(CheckResult, SaysWhatToDo) {
  expect_said(VK_ERROR_DEVICE_LOST,
              {"vkQueueSubmit", "the device was lost", "took too long", "whole", "another --device", "-4"});
  expect_said(VK_ERROR_OUT_OF_DEVICE_MEMORY, {"out of device memory", "fewer frames", "lighter", "--device cpu", "-2"});
  expect_said(VK_TIMEOUT, {"timed out", "hangs", "fewer frames", "another --device"});
}

TEST(NoDriver, IsAnErrorThatSaysSo) {
  const Environment files("VK_DRIVER_FILES", "/nonexistent.json"), names("VK_ICD_FILENAMES", "/nonexistent.json");
  EXPECT_TRUE(vulkan::list_devices().empty());
  EXPECT_FALSE(has_vulkan_device());
  EXPECT_FALSE(has_gpu());
  try {
    const vulkan::Device device({"auto", true, false});
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::device);
    EXPECT_NE(std::string(error.what()).find("this machine has no Vulkan device"), std::string::npos) << error.what();
  }
}

TEST(Validation, MissingLayerIsAnErrorThatNamesThePackage) {
  const Environment path("VK_LAYER_PATH", "/nonexistent");
  try {
    const vulkan::Device device(test_device());
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::device);
    EXPECT_NE(std::string(error.what()).find("vulkan-validationlayers"), std::string::npos) << error.what();
  }
}

class OpenDevice : public GpuTest {};

TEST_F(OpenDevice, IsListed) {
  const auto devices = vulkan::list_devices();
  ASSERT_GT(devices.size(), device_->info().index);
  const DeviceInfo& listed = devices[device_->info().index];
  EXPECT_EQ(listed.name, device_->info().name);
  EXPECT_EQ(listed.problem, "");
  EXPECT_GT(listed.memory_bytes, 0u);
  EXPECT_GE(listed.max_storage_buffer_range, 128u << 20);
  EXPECT_TRUE(has_vulkan_device());
}

// Libraries of drivers, of this process.
std::set<std::string> loaded_drivers() {
  std::set<std::string> libraries;
  std::ifstream maps("/proc/self/maps");
  for (std::string line; std::getline(maps, line);) {
    const std::string name = std::filesystem::path(line).filename().string();
    if (name.find("vulkan_") != std::string::npos || name.find("GLX_") != std::string::npos) libraries.insert(name);
  }
  return libraries;
}

// Not every driver can be loaded again and again.
TEST(CloseDevice, LeavesItsDriverLoaded) {
  std::set<std::string> open;
  {
    const vulkan::Device device(test_device());
    open = loaded_drivers();
  }
  if (open.empty()) GTEST_SKIP() << "a driver whose library has another name than is known here";
  EXPECT_EQ(loaded_drivers(), open);
}

TEST_F(OpenDevice, RefusesWhatItCannotHold) {
  EXPECT_THROW(vulkan::Buffer(*device_, std::uint64_t{1} << 50, vulkan::Memory::device, "a huge table"), Error);
  const vulkan::OutputNormals kernel(*device_);
  const vulkan::Buffer small(*device_, 16, vulkan::Memory::device, "small");
  vulkan::BufferRange huge = small;
  huge.size = device_->info().max_storage_buffer_range + 1;
  vulkan::Commands commands(*device_);
  commands.begin();
  const OutputNormalsPush push{64, 0, 64, 0};
  EXPECT_THROW(kernel.record(commands, {small, small, huge, small}, push, 1), Error);
  EXPECT_THROW(kernel.record(commands, {small, small, small, small}, push, device_->info().max_groups_y + 1), Error);
  commands.end();
}

// Many small buffers are pieces of few allocations, none of which overlap; all but the last go with their pieces.
TEST_F(OpenDevice, SmallBuffersShareAllocations) {
  constexpr std::size_t kCount = 300;
  Random random(1);
  std::vector<std::vector<float>> values;
  std::vector<vulkan::Buffer> buffers;
  std::map<const vulkan::MemoryBlock*, std::weak_ptr<const vulkan::MemoryBlock>> blocks;
  for (std::size_t k = 0; k < kCount; ++k) {
    values.push_back(random.floats(1 + random.below(9000), -1, 1));
    buffers.push_back(vulkan::upload(*device_, values.back(), "a small table"));
    EXPECT_EQ(buffers.back().memory().block->mapped, nullptr);  // reached by staging buffers alone, on lavapipe, too
    blocks[buffers.back().memory().block.get()] = buffers.back().memory().block;
  }
  EXPECT_LE(blocks.size(), 3u);  // 5.4 MB on average
  const vulkan::Buffer large = vulkan::floats(*device_, 1u << 20, "a large table");
  EXPECT_FALSE(blocks.contains(large.memory().block.get()));
  for (std::size_t k = 0; k < kCount; ++k) {
    const vulkan::Buffer staging(*device_, buffers[k].size(), vulkan::Memory::staging, "readback");
    vulkan::Commands commands(*device_);
    commands.begin();
    commands.copy(buffers[k], staging);
    commands.end();
    commands.run();
    EXPECT_EQ(std::memcmp(staging.mapped(), values[k].data(), values[k].size() * sizeof(float)), 0) << k;
  }
  buffers.clear();
  EXPECT_LE(std::ranges::count_if(blocks, [](const auto& block) { return !block.second.expired(); }), 1);
}

// Proof that validation messages reach us: a kernel that reads what is written before it, which the commands know, or
// do not know of.
TEST(Validation, SeesAMissingBarrier) {
  for (const bool is_known : {true, false}) {
    const vulkan::Device device(test_device());
    Random random(1);
    const MeshTable mesh = random_mesh(random, 64);
    const auto fans = vulkan::upload_together<vulkan::FanBuffers>(device, mesh, device.info());
    const vulkan::Buffer between(device, 64 * 12, vulkan::Memory::device, "between"),
        normals(device, 64 * 12, vulkan::Memory::device, "normals");
    const vulkan::OutputNormals read(device);
    vulkan::Commands commands(device);
    commands.begin();
    if (is_known) {
      commands.fill(between, 0);
    } else {
      vkCmdFillBuffer(commands.handle(), between.handle(), 0, VK_WHOLE_SIZE, 0);
    }
    vulkan::record_output_normals(commands, read, {fans, between, normals}, 64, 1);
    commands.end();
    const auto messages = device.validation_messages();
    if (is_known) {
      EXPECT_EQ(messages, std::vector<std::string>());
    } else {
      ASSERT_FALSE(messages.empty());
      EXPECT_NE(messages[0].find("SYNC-HAZARD-READ-AFTER-WRITE"), std::string::npos) << messages[0];
    }
  }
}

// What the layers say while a device is closed is heard too: here, of a fence that was forgotten.
TEST(Validation, HearsTeardown) {
  std::shared_ptr<const vulkan::ValidationLog> log;
  {
    const vulkan::Device device(test_device());
    log = device.validation_log();
    const VkFenceCreateInfo info{VK_STRUCTURE_TYPE_FENCE_CREATE_INFO, nullptr, 0};
    VkFence fence = VK_NULL_HANDLE;
    ASSERT_EQ(vkCreateFence(device.handle(), &info, nullptr, &fence), VK_SUCCESS);
  }
  EXPECT_FALSE(log->messages().empty());
}

}  // namespace
}  // namespace bodyopt::testing
