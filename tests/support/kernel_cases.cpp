#include "tests/support/kernel_cases.h"

namespace bodyopt::testing {

std::vector<std::vector<float>> outputs_of(const vulkan::Device& device, const KernelRun& run) {
  std::vector<std::size_t> counts;
  std::vector<vulkan::Buffer> before;
  for (const Expected& expected : run.outputs) {
    counts.push_back(expected.values.size());
    before.push_back(vulkan::upload(device, expected.before, "before"));
  }
  return run_kernel(device, counts, [&](auto& commands, const auto& outputs) {
    for (std::size_t o = 0; o < outputs.size(); ++o) {
      commands.copy({before[o], 0, sizeof(float) * run.outputs[o].before.size()}, outputs[o]);
    }
    run.record(commands, outputs);
  });
}

void expect_reference(const vulkan::Device& device, const std::string& kernel, const KernelRun& run) {
  const std::vector<std::vector<float>> found = outputs_of(device, run);
  for (std::size_t o = 0; o < found.size(); ++o) {
    const Expected& expected = run.outputs[o];
    const KernelTolerance* tolerance = find_tolerance(kernel, o);
    ASSERT_NE(tolerance, nullptr) << kernel << ", output " << o << ", has no tolerance";
    if (expected.compare) {
      expected.compare(found[o], tolerance->absolute);
    } else if (expected.is_exact) {
      expect_close(found[o], expected.values, 0);
    } else {
      expect_close(found[o], expected.values, tolerance->absolute, tolerance->relative);
    }
  }
}

std::vector<KernelCases>& kernel_cases() {
  static std::vector<KernelCases> all;
  return all;
}

bool add_kernel_cases(KernelCases cases) {
  kernel_cases().push_back(std::move(cases));
  return true;
}

bool add_kernel_cases(const char* kernel, const char* sized, decltype(KernelCases::make) make) {
  return add_kernel_cases({kernel, sized, "", {kSizes.begin(), kSizes.end()}, {0}, std::move(make)});
}

bool add_kernel_cases_of_frames(const char* kernel, const char* sized, decltype(KernelCases::make) make) {
  return add_kernel_cases(
      {kernel, sized, "frames", {kSizes.begin(), kSizes.end()}, {kFrames.begin(), kFrames.end()}, std::move(make)});
}

}  // namespace bodyopt::testing
