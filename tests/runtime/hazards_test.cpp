#include <gtest/gtest.h>

#include <array>

#include "runtime/vulkan/commands.h"

namespace bodyopt::testing {
namespace {

using vulkan::BufferUse;

// Names alone, of no buffer.
const auto kOne = reinterpret_cast<VkBuffer>(1), kOther = reinterpret_cast<VkBuffer>(2);

BufferUse reads(VkBuffer buffer, VkDeviceSize offset, VkDeviceSize size) { return {{buffer, offset, size}, false}; }
BufferUse writes(VkBuffer buffer, VkDeviceSize offset, VkDeviceSize size) { return {{buffer, offset, size}, true}; }

// Whether `next` waits where `earlier` was recorded before it.
bool waits(const BufferUse& earlier, const BufferUse& next) {
  vulkan::Hazards hazards;
  hazards.add({&earlier, 1});
  return hazards.before({&next, 1});
}

TEST(Hazards, ReadsWaitForWritesAndWritesForBoth) {
  EXPECT_FALSE(waits(reads(kOne, 0, 64), reads(kOne, 0, 64)));
  EXPECT_TRUE(waits(reads(kOne, 0, 64), writes(kOne, 0, 64)));
  EXPECT_TRUE(waits(writes(kOne, 0, 64), reads(kOne, 0, 64)));
  EXPECT_TRUE(waits(writes(kOne, 0, 64), writes(kOne, 0, 64)));
}

TEST(Hazards, AreOfTheSameBytes) {
  EXPECT_FALSE(waits(writes(kOne, 0, 64), reads(kOther, 0, 64)));
  for (const VkDeviceSize offset : {0, 64}) {  // on either side
    EXPECT_FALSE(waits(writes(kOne, offset, 64), reads(kOne, 64 - offset, 64)));
    EXPECT_TRUE(waits(writes(kOne, offset, 68), reads(kOne, 64 - offset, 68)));
  }
  EXPECT_TRUE(waits(writes(kOne, 0, 192), reads(kOne, 64, 64)));  // within
  EXPECT_TRUE(waits(writes(kOne, 64, 64), reads(kOne, 0, 192)));  // around
}

TEST(Hazards, AreOfAllUsesUntilABarrier) {
  vulkan::Hazards hazards;
  const std::array kernel = {reads(kOne, 0, 64), writes(kOther, 0, 64)},
                   next = {reads(kOne, 64, 64), reads(kOther, 0, 4)};
  EXPECT_FALSE(hazards.before(kernel));
  hazards.add(kernel);
  hazards.add({});
  EXPECT_TRUE(hazards.before(kernel));
  EXPECT_TRUE(hazards.before(next));
  EXPECT_FALSE(hazards.before(std::span(next).first(1)));
  hazards.clear();
  EXPECT_FALSE(hazards.before(next));
}

}  // namespace
}  // namespace bodyopt::testing
