// A frame allocates nothing, unless it is the first of so many: what operator new is asked for in this program.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <new>
#include <optional>

#include "include/bodyopt/vulkan.h"
#include "runtime/basis/attachments.h"
#include "runtime/basis/dynamics.h"
#include "runtime/core/executor.h"
#include "runtime/deformer/deformer.h"
#include "runtime/deformer/evaluate_together.h"
#include "runtime/host/device_choice.h"
#include "runtime/host/rig.h"
#include "runtime/vulkan/backend/device_model.h"
#include "tests/library/c_api.h"
#include "tests/library/shared_device.h"
#include "tests/support/gpu_fixture.h"
#include "tests/support/random_basis.h"
#include "tests/support/small_basis.h"

namespace {

std::atomic<std::size_t> allocation_count{0};  // of all threads

void* counted(void* memory) {
  ++allocation_count;
  return memory == nullptr ? throw std::bad_alloc() : memory;
}

}  // namespace

// Not inlined: GCC would take free() for another allocator's.
[[gnu::noinline]] void* operator new(std::size_t size) { return counted(std::malloc(std::max<std::size_t>(1, size))); }
[[gnu::noinline]] void* operator new(std::size_t size, std::align_val_t alignment) {
  const auto unit = static_cast<std::size_t>(alignment);
  return counted(std::aligned_alloc(unit, (std::max<std::size_t>(1, size) + unit - 1) / unit * unit));
}
[[gnu::noinline]] void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  ++allocation_count;
  return std::malloc(std::max<std::size_t>(1, size));
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }

namespace bodyopt::testing {
namespace {

// Of the second time.
std::size_t allocations_of(const auto& work) {
  work();
  const std::size_t before = allocation_count;
  work();
  return allocation_count - before;
}

std::vector<Pose> bent_poses(const Basis& basis, std::size_t count) {
  std::vector<Pose> poses(count, bind_pose(basis.skeleton));
  for (std::size_t f = 0; f < count; ++f) poses[f].joints[1].rotation = axis_angle({1, 0, 0}, 0.01 * double(f));
  return poses;
}

// With a fold at the second joint.
Basis pushed_out(Basis basis) {
  SkinModifier& fold = basis.modifiers.stack.emplace_back();
  fold.name = fold.type = kPushOut.name;
  fold.first_component = basis.modifiers.component_count();
  fold.component_count = kPushOut.components + kPushOut.joint_components;
  fold.joints = {1};
  fold.numbers = {0.2f, 0, 0, 0, 9, 0, 1, 0};
  return basis;
}

TEST(FrameAllocations, AreCounted) {
  EXPECT_EQ(allocations_of([] { std::vector<int>(7); }), 1u);
  EXPECT_EQ(allocations_of([] {}), 0u);
}

// On one thread: the others keep scratch of their own.
TEST(FrameAllocations, OnTheCpuAreNone) {
  const Basis plain = small_basis();
  const Basis modified = with_random_modifiers(plain, 4);
  for (const Basis& basis : {plain, with_on_top(modified, kRelax), pushed_out(modified)}) {
    Deformer deformer(model_of(basis), std::nullopt, {.name = "cpu", .executor = std::make_shared<SerialExecutor>()});
    for (const std::size_t count : {std::size_t{1}, std::size_t{5}, 2 * std::size_t{deformer.batch_limit()} + 2}) {
      std::vector<Pose> poses = bent_poses(basis, count);
      for (Pose& pose : poses) pose.modifiers.assign(basis.modifiers.component_count(), 1.0f);
      Evaluation evaluation;
      DeformerCall call{.deformer = &deformer, .poses = poses, .evaluation = &evaluation};
      EXPECT_EQ(allocations_of([&] { evaluate_together({&call, 1}); }), 0u) << count << " frames";
      EXPECT_EQ(call.error, nullptr);
      EXPECT_EQ(evaluation.positions.size(), 3 * count * basis.mesh.output_count());
    }
  }
}

// Also of skins that jiggle, and of those that modifiers move in the end.
TEST(FrameAllocations, OfRecordingAreNone) {
  DeviceChoice choice = test_device();
  choice.validation = false;  // its layers count, too
  const auto device = std::make_shared<const vulkan::Device>(choice);
  const Basis plain = small_basis(), own = load_basis(hero());
  const auto jiggling =
      std::make_shared<const CharacterModel>(CharacterModel{own, load_dynamics(hero_dynamics(), own)});
  for (const auto& model : {model_of(plain), model_of(pushed_out(with_random_modifiers(plain, 4))), jiggling}) {
    const Basis& basis = model->basis;
    const bool jiggles = model == jiggling;
    Deformer deformer(std::make_shared<const vulkan::DeviceModel>(device, model),
                      jiggles ? std::optional(JiggleOptions()) : std::nullopt);
    std::vector<Pose> poses = jiggles ? turning_poses(basis, 3) : bent_poses(basis, 3);
    for (Pose& pose : poses) pose.modifiers.assign(basis.modifiers.component_count(), 1.0f);
    const int numbers[] = {1, 2, 3};
    const std::optional<std::span<const int>> frames = jiggles ? std::optional(std::span(numbers)) : std::nullopt;
    const VkDeviceSize vertex = 3 * sizeof(float), frame = vertex * basis.mesh.output_count();
    const vulkan::Buffer target(*device, poses.size() * frame, vulkan::Memory::device, "the host's vertices");
    vulkan::Commands commands(*device);
    commands.begin();
    vulkan::Recording recording;
    recording.commands = commands.handle();
    recording.positions = recording.normals = {target.handle(), target.size(), 0, vertex, frame};
    recording.most_frames = 3;
    deformer.record(poses, frames, recording);  // of a jiggle the next one goes on from it
    EXPECT_EQ(allocations_of([&] { deformer.record(poses, frames, recording); }), 0u) << basis.mesh.output_count();
    commands.end();
  }
}

TEST(FrameAllocations, OfTheJiggleAreNone) {
  const Basis basis = load_basis(hero());
  Deformer deformer(basis, load_dynamics(hero_dynamics(), basis), {},
                    {.name = "cpu", .executor = std::make_shared<SerialExecutor>()});
  const std::vector<Pose> poses = turning_poses(basis, 3);
  const int frames[] = {1, 2, 3};
  Evaluation evaluation;
  DeformerCall call{.deformer = &deformer, .poses = poses, .evaluation = &evaluation, .frames = frames};
  evaluate_together({&call, 1});  // there is no motion before it to keep
  EXPECT_EQ(allocations_of([&] { evaluate_together({&call, 1}); }), 0u);
  EXPECT_EQ(call.error, nullptr);
}

// A call of the library with all outputs of the limb, its attached meshes, and what is recorded of it.
struct LibraryCall {
  LibraryCall() {
    for (const AttachedMesh& mesh : load_attachments(kept_file("hero.attached.safetensors"), basis).meshes) {
      attached.emplace_back(poses.size() * mesh.rest.size());
    }
    for (std::vector<float>& mesh : attached) outputs.push_back(floats_in(mesh));
    skin.all.attached = outputs.data();
    skin.all.attached_count = static_cast<std::uint32_t>(outputs.size());
    skin.all.expected_errors = floats_in(errors);
    skin.all.vertex_errors = floats_in(vertex_errors);
  }

  // The same poses as matrices.
  bodyopt_poses matrices() {
    bodyopt_poses matrices = given.all;
    for (const Pose& pose : poses) {
      for (const Affine& matrix : skinning_matrices(basis.skeleton, pose.joints)) {
        for (const auto& row : matrix.m) {
          for (const double x : row) skinning.push_back(static_cast<float>(x));
        }
      }
    }
    matrices.joints = nullptr;
    matrices.joint_stride = 0;
    matrices.skinning = skinning.data();
    return matrices;
  }

  Basis basis = load_basis(hero());
  api::Model model = api::load_model(hero(), "", kept_file("hero.attached.safetensors"));
  std::vector<Pose> poses = turning_poses(basis, 3);
  PoseArrays given{poses};
  Arrays skin{basis, poses.size()};
  std::vector<float> skinning, errors = std::vector<float>(poses.size()),
                               vertex_errors = std::vector<float>(poses.size() * basis.mesh.output_count());
  std::vector<std::vector<float>> attached;
  std::vector<bodyopt_floats> outputs;
};

TEST(FrameAllocations, OfTheLibraryAreNone) {
  LibraryCall call;
  const api::Instance instance = api::create_instance(call.model, api::make<bodyopt_instance_options>());
  for (const bodyopt_poses& poses : {call.given.all, call.matrices()}) {
    EXPECT_EQ(allocations_of([&] { EXPECT_EQ(bodyopt_evaluate(instance.get(), &poses, &call.skin.all), BODYOPT_OK); }),
              0u)
        << bodyopt_last_error();
  }
  EXPECT_GT(call.errors[2], 0);
  EXPECT_NE(call.attached[0][0], 0);
}

TEST(FrameAllocations, OfTheLibrarysRecordingAreNone) {
  DeviceChoice choice = test_device();
  choice.validation = false;  // its layers count, too
  const vulkan::Device device(choice);
  const api::Device shared = share(handles_of(device));
  LibraryCall call;
  auto options = api::make<bodyopt_instance_options>();
  options.device = shared.get();
  options.recorded_frames = 3;
  const api::Instance instance = api::create_instance(call.model, options);
  const vulkan::Buffer target(device, VkDeviceSize{1} << 22, vulkan::Memory::device, "the host's vertices");
  vulkan::Commands commands(device);
  commands.begin();
  auto recording = api::make<bodyopt_recording>();
  recording.commands = commands.handle();
  recording.positions = recording.normals = {target.handle(), target.size(), 0, 0};
  const std::vector<bodyopt_vulkan_output> attached(call.attached.size(), recording.positions);
  recording.attached = attached.data();
  recording.attached_count = static_cast<std::uint32_t>(attached.size());
  EXPECT_EQ(allocations_of([&] { EXPECT_EQ(bodyopt_record(instance.get(), &call.given.all, &recording), BODYOPT_OK); }),
            0u)
      << bodyopt_last_error();
  commands.end();
}

}  // namespace
}  // namespace bodyopt::testing
