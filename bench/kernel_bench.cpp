// Times each kernel by the device's timestamps, on the tables of its tests made large: one dispatch, or all windows of
// one. The device is lavapipe, unless BODYOPT_TEST_DEVICE names another.
#include <benchmark/benchmark.h>

#include "tests/support/kernel_cases.h"

namespace bodyopt::bench {
namespace {

using testing::KernelCases;
using testing::KernelRun;
using testing::KernelSet;
using testing::Trial;

constexpr std::uint32_t kSize = 4096;  // of regions' dense tables, too, which grow by its square

// The last variant has most frames, or right sides; what has no such sizes is at its largest.
Trial largest(const KernelCases& cases) {
  const std::uint32_t tested = cases.sizes.back();
  return {tested < kWorkgroupSize * 2 ? tested : kSize, cases.variants.back()};
}

void run_case(benchmark::State& state, KernelSet& kernels, const KernelCases& cases) {
  const KernelRun run = cases.make(kernels, largest(cases));
  std::vector<vulkan::Buffer> buffers;
  for (const testing::Expected& expected : run.outputs) {
    buffers.push_back(vulkan::floats(kernels.device(), expected.values.size(), "output"));
  }
  vulkan::Commands commands(kernels.device());
  commands.begin();
  commands.timestamp();
  run.record(commands, {buffers.begin(), buffers.end()});
  commands.timestamp();
  commands.end();
  for (auto _ : state) {
    commands.run();
    const std::vector<double> seconds = commands.seconds();
    if (seconds.empty()) return state.SkipWithError("the device has no timestamps");
    state.SetIterationTime(seconds.front());
  }
}

}  // namespace
}  // namespace bodyopt::bench

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  bodyopt::DeviceChoice choice = bodyopt::testing::test_device();
  choice.validation = false;
  const bodyopt::vulkan::Device device(choice);
  bodyopt::testing::KernelSet kernels(device);
  for (const bodyopt::testing::KernelCases& cases : bodyopt::testing::kernel_cases()) {
    benchmark::RegisterBenchmark(cases.kernel.c_str(), bodyopt::bench::run_case, std::ref(kernels), std::cref(cases))
        ->UseManualTime()
        ->Unit(benchmark::kMicrosecond);
  }
  benchmark::RunSpecifiedBenchmarks();
}
