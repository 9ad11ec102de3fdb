#include "tests/support/kernel_cases.h"

#include <set>
#include <sstream>

namespace bodyopt::testing {
namespace kernel_cases_test {

struct Chosen {
  const KernelCases* cases;
  Trial trial;
};

std::vector<Chosen> all_cases() {
  std::vector<Chosen> all;
  for (const KernelCases& cases : kernel_cases()) {
    for (const std::uint32_t size : cases.sizes) {
      for (const std::uint32_t variant : cases.variants) all.push_back({&cases, {size, variant}});
    }
  }
  return all;
}

std::string name_of(const Chosen& chosen) {
  const auto& [cases, trial] = chosen;
  std::string name = cases->kernel + "_" + std::to_string(trial.size) + "_" + cases->sized;
  if (!cases->varied.empty()) name += "_" + std::to_string(trial.variant) + "_" + cases->varied;
  return name + "_seed_" + std::to_string(trial.seed());
}

void PrintTo(const Chosen& chosen, std::ostream* to) { *to << name_of(chosen); }

class KernelCase : public GpuTest, public ::testing::WithParamInterface<Chosen> {
 protected:
  static void SetUpTestSuite() {
    GpuTest::SetUpTestSuite();
    kernels_ = std::make_unique<KernelSet>(*device_);
  }
  static void TearDownTestSuite() {
    kernels_.reset();
    GpuTest::TearDownTestSuite();
  }

  static inline std::unique_ptr<KernelSet> kernels_;
};

TEST_P(KernelCase, EqualsTheReference) {
  const auto& [cases, trial] = GetParam();
  expect_reference(*device_, cases->kernel, cases->make(*kernels_, trial));
}

INSTANTIATE_TEST_SUITE_P(Every, KernelCase, ::testing::ValuesIn(all_cases()),
                         [](const auto& chosen) { return name_of(chosen.param); });

// BODYOPT_KERNELS: of shaders/kernels, by CMake. Sizes: none, one, and both sides of a workgroup or of a block.
TEST(KernelCases, AreOfEveryKernelAtTheSizesThatMatter) {
  std::istringstream names(BODYOPT_KERNELS);
  const std::set<std::string> kernels(std::istream_iterator<std::string>(names), {});
  std::set<std::string> found;
  for (const KernelCases& cases : kernel_cases()) {
    EXPECT_TRUE(found.insert(cases.kernel).second) << cases.kernel << " has cases twice";
    const std::set<std::uint32_t> sizes(cases.sizes.begin(), cases.sizes.end());
    EXPECT_TRUE(sizes.contains(0) && sizes.contains(1)) << cases.kernel;
    const bool of_workgroups = sizes.contains(63) && sizes.contains(64) && sizes.contains(65) && sizes.contains(1237);
    const bool of_blocks = sizes.contains(15) && sizes.contains(16) && sizes.contains(31);
    EXPECT_TRUE(of_workgroups || of_blocks) << cases.kernel;
  }
  EXPECT_EQ(found, kernels);
  // As many outputs as have cases are looked up above; none is of a kernel that is no more.
  std::set<std::string> tolerated;
  for (const KernelTolerance& tolerance : kKernelTolerances) {
    tolerated.emplace(tolerance.kernel);
    EXPECT_EQ(find_tolerance(tolerance.kernel, tolerance.output), &tolerance) << tolerance.kernel << " twice";
  }
  EXPECT_EQ(tolerated, kernels);
}

}  // namespace kernel_cases_test
}  // namespace bodyopt::testing
