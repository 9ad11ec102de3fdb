// Every kernel beside its reference: what it is run on, and what it has to give. The tests of a kernel add its cases
// here, tests/kernels/kernel_cases_test.cpp runs those of all.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <typeindex>
#include <utility>
#include <vector>

#include "runtime/host/tolerances.h"
#include "tests/support/gpu_fixture.h"
#include "tests/support/random_tables.h"

namespace bodyopt::testing {

// Null where there is none.
inline const KernelTolerance* find_tolerance(std::string_view kernel, std::size_t output) {
  for (const KernelTolerance& tolerance : kKernelTolerances) {
    if (tolerance.kernel == kernel && tolerance.output == output) return &tolerance;
  }
  return nullptr;
}

// Kernels of one device, each made once.
class KernelSet {
 public:
  explicit KernelSet(const vulkan::Device& device) : device_(device) {}

  const vulkan::Device& device() const { return device_; }
  template <typename Kernel>
  const Kernel& get() {
    std::shared_ptr<const void>& made = made_[typeid(Kernel)];
    if (!made) made = std::make_shared<const Kernel>(device_);
    return *static_cast<const Kernel*>(made.get());
  }

 private:
  const vulkan::Device& device_;
  std::map<std::type_index, std::shared_ptr<const void>> made_;
};

// What one output has to be, within the tolerance that runtime/host/tolerances.h has for it.
struct Expected {
  std::vector<float> values;    // by the reference
  bool is_exact = false;        // bit for bit, whatever the tolerance is elsewhere
  std::vector<float> before{};  // what stands there, where the kernel leaves some of it
  // In place of number by number.
  std::function<void(const std::vector<float>& found, double tolerance)> compare{};
};

struct KernelRun {
  std::vector<Expected> outputs;
  Record record;  // owns what it binds, but for the kernel
};

// A kernel that binds its tables, in this order, and then its outputs.
template <typename Kernel, typename... Tables>
KernelRun run_on(KernelSet& kernels, const typename Kernel::Push& push, std::uint32_t frames,
                 std::vector<Expected> outputs, const std::vector<Tables>&... tables) {
  const auto buffers = std::make_shared<std::vector<vulkan::Buffer>>();
  (buffers->push_back(vulkan::upload(kernels.device(), tables, "a table")), ...);
  const Kernel& kernel = kernels.get<Kernel>();
  return {std::move(outputs), [&kernel, buffers, push, frames](vulkan::Commands& commands, const auto& out) {
            std::vector<vulkan::BufferRange> ranges(buffers->begin(), buffers->end());
            ranges.insert(ranges.end(), out.begin(), out.end());
            using Buffers = typename Kernel::Buffers;
            const auto bound = [&]<std::size_t... K>(std::index_sequence<K...>) { return Buffers{ranges.at(K)...}; };
            constexpr std::size_t kBindings = sizeof(Buffers) / sizeof(vulkan::BufferRange);
            ASSERT_EQ(ranges.size(), kBindings);
            kernel.record(commands, bound(std::make_index_sequence<kBindings>()), push, frames);
          }};
}

std::vector<std::vector<float>> outputs_of(const vulkan::Device& device, const KernelRun& run);

void expect_reference(const vulkan::Device& device, const std::string& kernel, const KernelRun& run);

struct Trial {
  std::uint32_t size, variant;
  std::uint32_t seed() const { return size + 31 * variant; }
};

struct KernelCases {
  std::string kernel;                // as its shader is named
  std::string sized, varied;         // what sizes and variants count: "vertices", "frames"
  std::vector<std::uint32_t> sizes;  // 0, 1, around a workgroup, and many
  std::vector<std::uint32_t> variants;
  std::function<KernelRun(KernelSet&, const Trial&)> make;
};

std::vector<KernelCases>& kernel_cases();

bool add_kernel_cases(KernelCases cases);

// Of the most usual sizes.
bool add_kernel_cases(const char* kernel, const char* sized, decltype(KernelCases::make) make);
bool add_kernel_cases_of_frames(const char* kernel, const char* sized, decltype(KernelCases::make) make);

}  // namespace bodyopt::testing
