// A device, and files of characters on a disk, shared by the tests of a suite; validation stays silent.
#pragma once

#include <cstring>

#include "runtime/vulkan/commands.h"
#include "tests/support/gpu_fixture.h"
#include "tests/viewport/small_character.h"

namespace bodyopt::testing {

inline std::vector<float> download(const vulkan::Device& device, const vulkan::Buffer& buffer) {
  const vulkan::Buffer readback(device, buffer.size(), vulkan::Memory::staging, "readback");
  vulkan::Commands commands(device);
  commands.begin();
  commands.copy(buffer, readback);
  commands.end();
  commands.run();
  std::vector<float> values(buffer.size() / sizeof(float));
  std::memcpy(values.data(), readback.mapped(), values.size() * sizeof(float));
  return values;
}

class CharactersTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    device_ = open_test_device();
    folder_ = std::make_unique<TemporaryFolder>();
    small_ = std::make_unique<SmallCharacter>(*folder_);
    jiggling_ = std::make_unique<JigglingCharacter>(*folder_);
    trained_ = std::make_unique<TrainedCharacter>(*folder_);
  }
  static void TearDownTestSuite() {
    small_.reset();
    jiggling_.reset();
    trained_.reset();
    folder_.reset();
    device_.reset();
  }
  void TearDown() override { EXPECT_EQ(device_->validation_messages(), std::vector<std::string>()); }

  static std::vector<float> download(const vulkan::Buffer& buffer) { return testing::download(*device_, buffer); }

  static inline std::shared_ptr<const vulkan::Device> device_;
  static inline std::unique_ptr<TemporaryFolder> folder_;
  static inline std::unique_ptr<SmallCharacter> small_;
  static inline std::unique_ptr<JigglingCharacter> jiggling_;
  static inline std::unique_ptr<TrainedCharacter> trained_;
};

}  // namespace bodyopt::testing
