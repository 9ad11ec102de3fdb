// Diffuse and jiggle on a Vulkan device: as on the CPU, and the same bits however a shot is cut.
#include "runtime/vulkan/backend/vulkan_dynamics.h"

#include <map>
#include <numeric>

#include "runtime/core/error.h"
#include "runtime/deformer/deformer.h"
#include "runtime/vulkan/backend/device_model.h"
#include "runtime/vulkan/backend/vulkan_backend.h"
#include "tests/support/capsule_limb.h"
#include "tests/support/error_kind.h"
#include "tests/support/gpu_fixture.h"
#include "tests/support/stage_seconds.h"
#include "tests/support/trained_basis.h"
#include "trainer/dynamics/build_dynamics.h"
#include "trainer/train/fit/train.h"

namespace bodyopt::testing {
namespace {

using namespace trainer;

// With muscles, which hold what jiggles as they shorten, and few tets.
struct JigglingLimb {
  explicit JigglingLimb(const JiggleStep& step) {
    const SampleSet samples = limb_samples(40, 0);
    basis = trained_basis(samples, {.centres = 10});
    DynamicsOptions options;
    options.resolution = 600;
    options.step = step;
    options.settings.softness = 4;
    dynamics = build_dynamics(samples.character, samples.muscles, basis, options).dynamics;
  }

  Basis basis;
  Dynamics dynamics;
};

const JigglingLimb& limb(const JiggleStep& step = {}) {
  static std::map<std::pair<std::uint32_t, bool>, JigglingLimb> limbs;
  return limbs.try_emplace({step.substeps, step.implicit_euler}, step).first->second;
}

// The limb bends and turns while all of it swings from side to side, 0.1 m, about once a second at 24 frames a second.
Pose waved_limb(int frame) {
  const double t = 0.25 * frame;
  Pose pose = limb_pose(limb_skeleton(), 0.5 - 0.5 * std::cos(t), 0.3 * std::sin(0.7 * t), 0.4 * std::sin(1.3 * t));
  pose.joints[0].translation = {0.1 * std::sin(t), 0, 0.05 * std::cos(1.7 * t)};
  return pose;
}

struct Shot {
  explicit Shot(std::vector<int> numbers) : frames(std::move(numbers)) {
    for (const int frame : frames) poses.push_back(waved_limb(frame));
  }

  Evaluation run(Deformer& deformer, std::size_t begin, std::size_t end) const {
    return deformer.jiggle(std::span(poses).subspan(begin, end - begin), std::span(frames).subspan(begin, end - begin));
  }
  Evaluation run(Deformer& deformer) const { return run(deformer, 0, poses.size()); }

  std::vector<int> frames;
  std::vector<Pose> poses;
};

Shot steady(int count) {
  std::vector<int> frames(static_cast<std::size_t>(count));
  std::iota(frames.begin(), frames.end(), 1);
  return Shot(frames);
}

Deformer on(const DeviceChoice& choice, const JiggleOptions& options = {}, const JigglingLimb& of = limb()) {
  return Deformer(of.basis, of.dynamics, options, choice);
}

// The largest distance of two numbers.
float distance(const std::vector<float>& a, const std::vector<float>& b) {
  EXPECT_EQ(a.size(), b.size());
  float largest = 0;
  for (std::size_t k = 0; k < std::min(a.size(), b.size()); ++k) largest = std::max(largest, std::abs(a[k] - b[k]));
  return largest;
}

void append(const Evaluation& part, Evaluation& whole) {
  whole.positions.insert(whole.positions.end(), part.positions.begin(), part.positions.end());
  whole.normals.insert(whole.normals.end(), part.normals.begin(), part.normals.end());
}

void expect_same_bits(const Evaluation& a, const Evaluation& b) {
  EXPECT_FALSE(a.positions.empty());
  EXPECT_EQ(a.positions, b.positions);
  EXPECT_EQ(a.normals, b.normals);
}

void expect_same_motion(const NodeMotion& a, const NodeMotion& b) {
  EXPECT_FALSE(a.displacement.empty());
  EXPECT_EQ(a.displacement, b.displacement);
  EXPECT_EQ(a.velocity, b.velocity);
  EXPECT_EQ(a.nodes, b.nodes);
  EXPECT_EQ(a.node_velocity, b.node_velocity);
}

// A shot with a frame twice, frames left out, a cut, a gap and a step back.
TEST(VulkanDynamics, EqualsTheCpu) {
  std::vector<int> numbers(16);
  std::iota(numbers.begin(), numbers.end(), 1);
  for (const int frame : {16, 19, 20, 21, 22, 50, 51, 52, 40, 41, 42, 43}) numbers.push_back(frame);
  const Shot shot(numbers);
  const JiggleOptions options{.gravity_change = {3, 0, 9}, .cuts = {21}};
  const JigglingLimb& euler = limb({.substeps = 2, .implicit_euler = true});
  for (const auto& [name, of] : {std::pair("plain", &limb()), {"Euler, two steps a frame", &euler}}) {
    SCOPED_TRACE(name);
    Deformer cpu = on({.name = "cpu"}, options, *of), gpu = on(test_device(), options, *of);
    const Evaluation expected = shot.run(cpu), actual = shot.run(gpu);
    EXPECT_GT(distance(expected.positions, cpu.evaluate(shot.poses).positions), 1e-3);
    EXPECT_LT(distance(actual.positions, expected.positions), 6e-7);  // a millionth of the limb
    expect_close(actual.normals, expected.normals, 1e-4);
    EXPECT_EQ(actual.starts, expected.starts);
    expect_close(gpu.state().motion.displacement, cpu.state().motion.displacement, 6e-7);
  }
}

// With eight steps a frame a batch takes fewer frames than these: whole, the shot is cut as well.
TEST(VulkanDynamics, CutsIntoCallsAndBatchesChangeNoBit) {
  const Shot shot = steady(24);
  for (const std::uint32_t substeps : {1u, 8u}) {
    SCOPED_TRACE(substeps);
    const JigglingLimb& of = limb({.substeps = substeps});
    Deformer whole = on(test_device(), {}, of), cut = on(test_device(), {}, of);
    const Evaluation expected = shot.run(whole);
    Evaluation actual;
    std::size_t begin = 0;
    for (const std::size_t end : {1u, 2u, 5u, 8u, 24u}) {
      append(shot.run(cut, begin, end), actual);
      // The quasi-static skin in between leaves the motion alone; as many frames as the next call has, or others.
      cut.evaluate(std::span(shot.poses).first(3));
      begin = end;
    }
    expect_same_bits(actual, expected);
    expect_same_motion(cut.state().motion, whole.state().motion);
  }
}

// A batch fails while the one before it runs: what was stepped is taken back.
TEST(VulkanDynamics, ABatchThatFailsBesideAnotherLeavesTheMotion) {
  const Shot shot = steady(24);
  const JigglingLimb& of = limb({.substeps = 8});
  Deformer deformer = on(test_device(), {}, of), other = on(test_device(), {}, of);
  ASSERT_LT(2 * deformer.batch_limit(), 23u);
  shot.run(deformer, 0, 1);
  shot.run(other, 0, 1);
  const JiggleState before = deformer.state();
  Shot bad = shot;
  bad.poses[1 + 2 * std::size_t{deformer.batch_limit()}].joints.pop_back();
  EXPECT_EQ(kind_of([&] { bad.run(deformer, 1, 24); }), ErrorKind::mismatch);
  expect_same_motion(deformer.state().motion, before.motion);
  expect_same_bits(shot.run(deformer, 1, 24), shot.run(other, 1, 24));
}

TEST(VulkanDynamics, LimitsBatches) {
  const auto limit = [](const Dynamics& dynamics) {
    const auto model = std::make_shared<const CharacterModel>(CharacterModel{limb().basis, dynamics});
    return make_vulkan_backend(std::make_shared<const vulkan::DeviceModel>(open_test_device(), model), JiggleOptions())
        ->batch_limit();
  };
  Dynamics many_steps = limb().dynamics;
  many_steps.jiggle.step.substeps = 1000;
  EXPECT_EQ(limit(many_steps), 1u);
  EXPECT_GE(limit(limb().dynamics), 24u);
  EXPECT_LT(limit(limb({.substeps = 8}).dynamics), 24u);
}

// Frames 1, 2 and 22 of a limb that is pushed sideways, in submissions of so many dispatches.
struct PushedLimb {
  PushedLimb(const vulkan::Device& device, std::uint32_t most_dispatches) {
    const auto& [basis, dynamics] = limb();
    const JiggleOptions options;
    std::vector<float> positions;
    std::vector<JiggleFrame> frames;
    JiggleState state;
    const double origin[3] = {};
    for (const auto& [frame, x] : {std::pair(1, 0.0f), {2, 0.1f}, {22, 8.0f}}) {
      const double joint[3] = {static_cast<double>(x), 0, 0};
      frames.push_back(plan_frame(frame, joint, origin, 10, dynamics.jiggle.step, options, state));
      for (std::size_t k = 0; k < basis.mesh.rest.size(); ++k) {
        positions.push_back(basis.mesh.rest[k] + (k % 3 == 0 ? x : 0));
      }
    }
    const std::uint32_t fibres = basis.strain.fibre_count();
    const vulkan::Buffer skin = upload(device, positions, "the skin");
    const vulkan::Buffer zeros = upload(device, std::vector<float>(3 * (4 + fibres)), "zeros");
    const std::shared_ptr<const vulkan::Device> not_owned(std::shared_ptr<void>(), &device);
    const vulkan::DeviceModel model(not_owned, std::make_shared<const CharacterModel>(CharacterModel{basis, dynamics}));
    vulkan::VulkanDynamics device_dynamics(model, options);
    device_dynamics.prepare(3);
    vulkan::Commands commands(device, most_dispatches);
    commands.begin();
    const vulkan::VulkanDynamics::Inputs inputs{skin, zeros, zeros, zeros, fibres, 0, 3};
    device_dynamics.record_diffuse(commands, inputs);
    device_dynamics.record_jiggle(commands, inputs, frames, 1);
    commands.end();
    commands.run();
    submissions = commands.submission_count();
    motion = device_dynamics.motion();
  }

  std::uint32_t submissions;
  NodeMotion motion;
};

TEST(VulkanDynamics, LongFramesAreManySubmissionsOfTheSameBits) {
  const vulkan::Device device(test_device());
  const PushedLimb whole(device, ~0u), cut(device, 1);
  // What 20 frames of damping leave of the push.
  EXPECT_GT(distance(whole.motion.displacement, std::vector<float>(whole.motion.displacement.size())), 1e-7);
  expect_same_motion(cut.motion, whole.motion);
  EXPECT_EQ(whole.submissions, 1u);
  EXPECT_EQ(cut.submissions, 1u + 21u);  // 21 steps
  EXPECT_EQ(device.validation_messages(), std::vector<std::string>());
}

// As many dispatches as no submission takes: what the host sends must be there when the first one runs.
TEST(VulkanDynamics, LongFramesEqualTheCpu) {
  constexpr std::uint32_t kSubsteps = 32;
  const JigglingLimb& of = limb({.substeps = kSubsteps});
  ASSERT_GT(20 * kSubsteps * 2 * 3 * of.dynamics.jiggle.inverse.levels.size(), vulkan::Commands::kMostDispatches);
  const Shot shot({1, 2, 22});
  Deformer cpu = on({.name = "cpu"}, {}, of), gpu = on(test_device(), {}, of);
  const Evaluation expected = shot.run(cpu), actual = shot.run(gpu);
  EXPECT_EQ(actual.starts.back(), JiggleStart::goes_on);
  EXPECT_LT(distance(actual.positions, expected.positions), 6e-7);
  EXPECT_GT(actual.stage_seconds.of(Stage::jiggle), 0);
}

TEST(VulkanDynamics, GoesOnFromAState) {
  const Shot shot = steady(12);
  Deformer first = on(test_device());
  EXPECT_EQ(first.state().known, 0u);
  shot.run(first, 0, 7);
  const JiggleState state = first.state();
  const Evaluation expected = shot.run(first, 7, 12);
  Deformer second = on(test_device());
  shot.run(second, 3, 5);
  second.set_state(state);
  expect_same_motion(second.state().motion, state.motion);
  expect_same_bits(shot.run(second, 7, 12), expected);
  first.set_state(state);
  expect_same_bits(shot.run(first, 7, 12), expected);
  // Nothing known: as new.
  first.set_state({});
  Deformer fresh = on(test_device());
  expect_same_bits(shot.run(first), shot.run(fresh));
}

// The first batches of a call that fails have run: their motion is taken back.
TEST(VulkanDynamics, FailedCallLeavesTheMotion) {
  Deformer deformer = on(test_device(), {}, limb({.substeps = 8}));
  Shot shot = steady(24);
  shot.run(deformer, 0, 2);
  const NodeMotion before = deformer.state().motion;
  shot.poses.back().joints.pop_back();
  EXPECT_THROW(shot.run(deformer, 2, 24), Error);
  expect_same_motion(deformer.state().motion, before);
}

TEST(VulkanDynamics, HeldPoseIsTheQuasiStaticSkin) {
  Deformer deformer = on(test_device());
  Shot shot = steady(5);
  for (Pose& pose : shot.poses) pose = waved_limb(9);
  expect_same_bits(shot.run(deformer), deformer.evaluate(shot.poses));
}

TEST(VulkanDynamics, TimesEveryStage) {
  Deformer deformer = on(test_device());
  const Shot shot = steady(2);
  expect_times(shot.run(deformer).stage_seconds,
               {Stage::rig, Stage::strain, Stage::residual, Stage::pose, Stage::diffuse, Stage::jiggle, Stage::output});
  expect_times(deformer.evaluate(shot.poses).stage_seconds,
               {Stage::rig, Stage::strain, Stage::residual, Stage::pose, Stage::output});
}

// Lavapipe, which is all that tests see of Vulkan, is slower than the CPU path.
TEST(Deformer, AutoTakesASoftwareDeviceOnlyWhenADeviceIsRequired) {
  open_test_device();
  if (has_gpu()) GTEST_SKIP() << "there is a GPU";
  EXPECT_EQ(Deformer(limb().basis, DeviceChoice{}).device_name(), "cpu");
  EXPECT_NE(Deformer(limb().basis, {.name = "auto", .require_device = true}).device_name(), "cpu");
}

}  // namespace
}  // namespace bodyopt::testing
