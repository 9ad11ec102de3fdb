// What is simulated and learned does not depend on the processor: where the C library finds no FMA it computes exp, sin
// and their like by other instructions, and to other last bits.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <string>

#include "tests/cli/limb_files.h"
#include "tests/support/environment.h"
#include "tests/support/read_bytes.h"
#include "tests/support/run_program.h"

namespace bodyopt {
namespace {

constexpr const char* kWithoutFma = "glibc.cpu.hwcaps=-FMA,-AVX2,-AVX,-AVX512F";

// An odd number of frames: Eigen leaves the last of an odd number of elements to the C library.
TEST(SameBits, ADatasetTrainsToOneFileOnProcessorsWithAndWithoutFma) {
  const TemporaryFolder folder;
  const LimbFiles files(folder, 1);
  const std::string data = (folder / "data").string();
  const ProgramResult simulated = run_bodyopt("simulate " + files.character + " --clip " + files.motion +
                                              " --fps 120 --draft --frames 1-25 --out " + data);
  ASSERT_EQ(simulated.exit_code, 0) << simulated.output;
  const auto trained = [&](const std::string& name) {
    const auto basis = folder / (name + ".safetensors");
    const ProgramResult result = run_bodyopt("train " + data + " --surface-curves 2 --out " + basis.string());
    EXPECT_EQ(result.exit_code, 0) << result.output;
    return testing::read_bytes(basis);
  };
  const std::string with = trained("with");
  const testing::Environment without_fma("GLIBC_TUNABLES", kWithoutFma);
  const std::string without = trained("without");
  ASSERT_GT(with.size(), 0u);
  EXPECT_EQ(with, without);
}

// Poses far enough from rest that the solver comes to them through others.
TEST(SameBits, AClipIsSimulatedToOneCacheOnProcessorsWithAndWithoutFma) {
  const TemporaryFolder folder;
  const LimbFiles files(folder, 1);
  const auto simulated = [&](const std::string& name) {
    const ProgramResult result = run_bodyopt("simulate " + files.character + " --clip " + files.motion +
                                             " --frames 4-6 --out " + (folder / name).string());
    EXPECT_EQ(result.exit_code, 0) << result.output;
    return testing::read_bytes(folder / name / "bend.pc2");
  };
  const std::string with = simulated("with");
  const testing::Environment without_fma("GLIBC_TUNABLES", kWithoutFma);
  ASSERT_GT(with.size(), 0u);
  EXPECT_EQ(with, simulated("without"));
}

// Where Eigen cuts sums into blocks by the caches that it finds, their bits are the processor's. This is what it takes
// where it does not look.
TEST(SameBits, ProductsAreCutAlikeWhateverTheCaches) {
  EXPECT_EQ(Eigen::l1CacheSize(), Eigen::internal::defaultL1CacheSize);
  EXPECT_EQ(Eigen::l2CacheSize(), Eigen::internal::defaultL2CacheSize);
}

}  // namespace
}  // namespace bodyopt
