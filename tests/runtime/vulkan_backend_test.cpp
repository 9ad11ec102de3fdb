#include "runtime/vulkan/backend/vulkan_backend.h"

#include <algorithm>
#include <chrono>

#include "runtime/core/error.h"
#include "runtime/cpu/cpu_backend.h"
#include "runtime/deformer/deformer.h"
#include "runtime/vulkan/backend/device_model.h"
#include "tests/support/gpu_fixture.h"
#include "tests/support/random_basis.h"
#include "tests/support/stage_seconds.h"

namespace bodyopt::testing {
namespace {

std::unique_ptr<Backend> on_device(const Basis& basis) {
  const auto model = model_of(basis);
  return make_vulkan_backend(std::make_shared<const vulkan::DeviceModel>(open_test_device(), model));
}

void expect_equal(const BatchResult& gpu, const BatchResult& cpu) {
  expect_close(gpu.strains, cpu.strains, 1e-5, 1e-5);  // metres of 1e-6 over rest lengths of decimetres
  expect_close(gpu.excess, cpu.excess, 1e-4);
  expect_close(gpu.coefficients, cpu.coefficients, 2e-4);  // strains times inverse scales and weights
  expect_close(gpu.positions, cpu.positions, 1e-5);
  // Random triangles: a normal is as exact as its sum of areas is long.
  expect_close(gpu.normals, cpu.normals, 5e-3);
}

TEST(VulkanBackend, EqualsTheCpuBackend) {
  for (const auto& [fibres, coefficients] : {std::pair(20u, 70u), {0u, 70u}, {20u, 0u}, {0u, 0u}}) {
    SCOPED_TRACE(std::to_string(fibres) + " fibres, " + std::to_string(coefficients) + " coefficients");
    const Basis basis = random_basis(fibres, coefficients);
    const auto cpu = make_cpu_backend(model_of(basis)), gpu = on_device(basis);
    EXPECT_GE(gpu->batch_limit(), 64u);
    // Recorded for one frame, again for three, submitted again, and again for one.
    for (const std::uint32_t frames : {1u, 3u, 3u, 1u}) {
      const Batch batch = random_batch(basis, frames);
      expect_equal(gpu->run(batch), cpu->run(batch));
    }
    EXPECT_TRUE(gpu->run(Batch{}).positions.empty());
    const auto begin = std::chrono::steady_clock::now();
    const BatchResult whole = gpu->run(random_batch(basis, 130));
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - begin;
    EXPECT_EQ(whole.positions.size(), 130u * kBasisVertices * 3);
    EXPECT_EQ(whole.positions, gpu->run(random_batch(basis, 130)).positions);
    EXPECT_LE(whole.stage_seconds.sum(),
              1.01 * elapsed.count());  // a difference of timestamps that wraps round is minutes
  }
}

// The memory of a result is that of the one before: nothing of it is left.
TEST(VulkanBackend, AndTheCpuBackendGiveWhatABatchAsksForAndNoMore) {
  const Basis basis = random_basis(20, 70);
  for (const auto& backend : {make_cpu_backend(model_of(basis)), on_device(basis)}) {
    SCOPED_TRACE(backend->name());
    Batch batch = random_batch(basis, 3);
    const BatchResult plain = backend->run(batch);
    batch.keeps_posed = true;
    EXPECT_EQ(backend->run(batch).posed, plain.positions);
    batch.keeps_posed = batch.wants_normals = false;
    const BatchResult& result = backend->run(batch);
    EXPECT_TRUE(result.posed.empty());
    EXPECT_TRUE(result.normals.empty());
    EXPECT_EQ(result.positions, plain.positions);
    EXPECT_EQ(result.strains, plain.strains);
    const float* positions = result.positions.data();
    EXPECT_EQ(backend->run(random_batch(basis, 2)).positions.size(), 2u * kBasisVertices * 3);
    EXPECT_EQ(backend->run(batch).positions.data(), positions);
  }
}

TEST(VulkanBackend, ModifiersEqualTheCpuBackend) {
  for (const std::uint32_t coefficients : {70u, 0u}) {
    const Basis plain = random_basis(20, coefficients), basis = with_random_modifiers(plain, 7);
    const auto cpu = make_cpu_backend(model_of(basis)), gpu = on_device(basis);
    Batch batch = random_batch(basis, 3);
    const BatchResult shown = gpu->run(batch);
    expect_equal(shown, cpu->run(batch));
    EXPECT_TRUE(shown.stage_seconds.of(Stage::modify));
    EXPECT_NE(shown.positions, on_device(plain)->run(batch).positions);
    std::fill(batch.modifiers.begin(), batch.modifiers.end(), 0.0f);
    EXPECT_EQ(gpu->run(batch).positions, on_device(plain)->run(batch).positions);
    EXPECT_EQ(cpu->run(batch).positions, make_cpu_backend(model_of(plain))->run(batch).positions);
  }
}

// Strains are of the skinning before modifiers turned joints, on either, and the skin is of that after.
TEST(VulkanBackend, StrainsOfTurnedJointsEqualTheCpuBackend) {
  const Basis plain = with_random_modifiers(random_basis(20, 70), 2);
  Basis turning = plain;
  turning.modifiers.stack[0].turns = {{1, 0, 0.1f, 0, 0}};
  const auto cpu = make_cpu_backend(model_of(turning)), gpu = on_device(turning);
  Batch batch = random_batch(plain, 3), before = batch;
  batch.learned_skinning = batch.skinning;
  const std::vector<float> unturned = gpu->run(batch).positions;
  EXPECT_EQ(unturned, on_device(plain)->run(before).positions);
  EXPECT_EQ(cpu->run(batch).positions, make_cpu_backend(model_of(plain))->run(before).positions);
  const std::vector<float> strains = gpu->run(batch).strains;
  const std::size_t one = batch.skinning.size() / 3;  // the second frame turns
  std::copy_n(random_batch(plain, 4).skinning.begin(), one, batch.skinning.begin() + static_cast<std::ptrdiff_t>(one));
  const BatchResult shown = gpu->run(batch);
  expect_equal(shown, cpu->run(batch));
  EXPECT_EQ(shown.strains, strains);
  EXPECT_NE(shown.positions, unturned);
}

TEST(VulkanBackend, RelaxEqualsTheCpuBackend) {
  const Basis plain = with_random_modifiers(random_basis(20, 70), 7), basis = with_on_top(plain, kRelax);
  const auto cpu = make_cpu_backend(model_of(basis)), gpu = on_device(basis), without = on_device(plain);
  Batch batch = random_batch(basis, 3), same = batch;
  same.modifiers.resize(std::size_t{3} * 7);
  const auto relax = [&](const std::vector<float>& weights) {
    for (std::size_t f = 0; f < 3; ++f) {
      batch.modifiers[8 * f + 7] = weights[f];
      std::copy_n(&batch.modifiers[8 * f], 7, &same.modifiers[7 * f]);
    }
  };
  relax({0, 0, 0});
  const std::vector<float> before = without->run(same).positions;
  EXPECT_EQ(gpu->run(batch).positions, before);
  EXPECT_EQ(cpu->run(batch).positions, make_cpu_backend(model_of(plain))->run(same).positions);
  for (const std::vector<float>& weights : {std::vector<float>{0.7f, 0, 1}, {0, 0.5f, 1}}) {
    relax(weights);
    const BatchResult shown = gpu->run(batch);
    expect_equal(shown, cpu->run(batch));
    EXPECT_NE(shown.positions, before);
  }
  relax({0, 0, 0});
  EXPECT_EQ(gpu->run(batch).positions, before);
}

// After relax, and alone; with normals and without.
TEST(VulkanBackend, PushOutEqualsTheCpuBackend) {
  const Basis plain = with_random_modifiers(random_basis(20, 70), 7);
  for (const Basis& basis : {with_on_top(plain, kPushOut), with_on_top(with_on_top(plain, kRelax), kPushOut)}) {
    const std::size_t components = basis.modifiers.component_count(), first = components - 6;
    const auto cpu = make_cpu_backend(model_of(basis)), gpu = on_device(basis);
    Batch batch = random_batch(basis, 3);
    const auto push_out = [&](float shown) {
      for (std::size_t k = 0; k < batch.modifiers.size(); ++k) {
        if (k % components >= first)
          batch.modifiers[k] = shown * static_cast<float>(k % 5) / 7 * (k % 2 == 0 ? 1.0f : -1.0f);
      }
    };
    push_out(0);
    const std::vector<float> before = gpu->run(batch).positions;
    for (const bool normals : {true, false}) {
      batch.wants_normals = normals;
      push_out(1);
      const BatchResult shown = gpu->run(batch);
      expect_equal(shown, cpu->run(batch));
      EXPECT_NE(shown.positions, before);
      push_out(0);
      EXPECT_EQ(gpu->run(batch).positions, before);
    }
    // Nothing in the stack is at work.
    std::fill(batch.modifiers.begin(), batch.modifiers.end(), 0.0f);
    Batch bare = batch;
    bare.modifiers.resize(std::size_t{3} * 7);
    EXPECT_EQ(gpu->run(batch).positions, on_device(plain)->run(bare).positions);
    EXPECT_EQ(cpu->run(batch).positions, make_cpu_backend(model_of(plain))->run(bare).positions);
  }
}

TEST(VulkanBackend, RestCoefficientsAreTakenOutExactly) {
  const Basis basis = random_basis(20, 70);
  const auto gpu = on_device(basis);
  Batch batch = random_batch(basis, 1);
  std::fill(batch.fades.begin(), batch.fades.end(), 1.0f);  // as at rest
  gpu->set_rest_coefficients(gpu->run(batch).coefficients);
  const BatchResult rest = gpu->run(batch);
  EXPECT_EQ(rest.coefficients, std::vector<float>(70, 0.0f));
  // Without coefficients the residual moves nothing: the same bits as without a residual.
  Basis without = basis;
  without.residual = random_basis(20, 0).residual;
  EXPECT_EQ(on_device(without)->run(batch).positions, rest.positions);
}

// Instances of one model share its tables, and nothing else.
TEST(VulkanBackend, InstancesOfAModelDoNotDisturbEachOther) {
  const Basis basis = random_basis(20, 70);
  const auto model = std::make_shared<const vulkan::DeviceModel>(open_test_device(), model_of(basis));
  const auto one = make_vulkan_backend(model), other = make_vulkan_backend(model);
  const Batch first = random_batch(basis, 3), second = random_batch(basis, 5);
  const std::vector<float> alone = on_device(basis)->run(first).positions;
  other->set_weights({.correction = 0});
  other->set_rest_coefficients(std::vector<float>(70, 0.5f));
  other->run(second);
  EXPECT_EQ(one->run(first).positions, alone);
  other->run(second);
  EXPECT_EQ(one->run(first).positions, alone);
}

// A device whose bindings see little: tables by blocks of vertices are seen through windows, others are named.
TEST(VulkanBackend, SeesTablesThroughWindows) {
  const Basis basis = with_on_top(with_random_modifiers(random_basis(20, 70), 7), kRelax);
  const auto model = model_of(basis);
  const auto device = open_test_device();
  vulkan::DeviceInfo limits = device->info();
  limits.storage_alignment = 256;
  const auto backend = [&](std::uint64_t range) {
    limits.max_storage_buffer_range = range;
    const auto tables = std::make_shared<const vulkan::DeviceModel>(device, model, limits);
    EXPECT_EQ(tables->tables().ddm.windows.size() > 1, range < 1u << 20);
    EXPECT_EQ(tables->tables().fans.windows.size() > 1, range < 1u << 20);
    return make_vulkan_backend(tables);
  };
  Batch batch = random_batch(basis, 1);
  for (std::size_t k = 7; k < batch.modifiers.size(); k += 8) batch.modifiers[k] = 0.7f;
  const auto whole = backend(device->info().max_storage_buffer_range), windows = backend(8000);
  EXPECT_EQ(windows->batch_limit(), 1u);
  const BatchResult expected = whole->run(batch), found = windows->run(batch);
  EXPECT_EQ(found.positions, expected.positions);
  EXPECT_EQ(found.normals, expected.normals);
  EXPECT_EQ(found.strains, expected.strains);

  try {
    backend(4000);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::device);
    for (const char* said : {"the skin at rest: 6012 bytes, which", "more than the 4000 bytes", "the CPU"}) {
      EXPECT_NE(std::string(error.what()).find(said), std::string::npos) << said << " is not in: " << error.what();
    }
  }
}

// A device that starts few groups: what kernels without windows run over is named before anything is uploaded.
TEST(VulkanBackend, NamesWhatItCannotStartThreadsFor) {
  const auto device = open_test_device();
  vulkan::DeviceInfo limits = device->info();
  limits.max_groups_x = 1;
  const auto put_on_the_device = [&](const Basis& basis) { vulkan::DeviceModel(device, model_of(basis), limits); };
  EXPECT_NO_THROW(put_on_the_device(random_basis(5, 0)));  // 501 vertices, through windows
  try {
    put_on_the_device(random_basis(20, 70));
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::device);
    for (const char* said : {"the features: 67 threads", "more than the 64", "the CPU has no such limit"}) {
      EXPECT_NE(std::string(error.what()).find(said), std::string::npos) << said << " is not in: " << error.what();
    }
  }
}

// Weights of zero on all kernels.
TEST(VulkanBackend, WithoutKernelsIsLinear) {
  const Basis basis = random_basis(20, 70);
  Basis linear = basis;
  for (const Region& region : linear.residual.regions) {
    const std::size_t columns = std::size_t{1} + region.coordinate_count + region.centre_count;
    for (std::size_t k = 0; k < region.coefficient_count * columns; ++k) {
      if (k % columns > region.coordinate_count) linear.residual.weights[region.weight_values + k] = 0;
    }
  }
  const Batch batch = random_batch(basis, 3);
  const auto cpu = make_cpu_backend(model_of(basis)), gpu = on_device(basis);
  const std::vector<float> whole = cpu->run(batch).coefficients;
  for (Backend* backend : {cpu.get(), gpu.get()}) backend->set_weights({.kernels = false});
  EXPECT_EQ(cpu->run(batch).coefficients, make_cpu_backend(model_of(linear))->run(batch).coefficients);
  EXPECT_EQ(gpu->run(batch).coefficients, on_device(linear)->run(batch).coefficients);
  EXPECT_NE(cpu->run(batch).coefficients, whole);
}

TEST(VulkanBackend, TimesEveryStage) {
  if (open_test_device()->timestamp_mask() == 0) GTEST_SKIP() << "the device has no timestamps";
  const Basis basis = random_basis(20, 70);
  const Batch batch = random_batch(basis, 2);
  expect_times(on_device(basis)->run(batch).stage_seconds, stages_of(basis, batch));
}

TEST(VulkanBackend, RefusesUnknownDevices) {
  DeviceChoice choice = test_device();
  choice.name = "no such device";
  EXPECT_THROW(vulkan::Device device(choice), Error);
}

}  // namespace
}  // namespace bodyopt::testing
