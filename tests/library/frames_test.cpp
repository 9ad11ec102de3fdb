// Frames by bodyopt.h are those of the runtime, bit for bit, wherever they are written and whoever lends the threads.
#include <cstddef>
#include <thread>

#include "runtime/basis/dynamics.h"
#include "runtime/coverage/expected_error.h"
#include "tests/library/c_api.h"
#include "tests/support/gpu_fixture.h"
#include "tests/support/small_basis.h"
#include "tests/support/temporary_folder.h"

namespace bodyopt::testing {
namespace frames_test {

constexpr std::size_t kFrames = 5;
const api::Device kNoDevice;

void expect_same(const Arrays& found, const Evaluation& expected) {
  EXPECT_EQ(found.positions, expected.positions);
  EXPECT_EQ(found.normals, expected.normals);
  EXPECT_EQ(found.strains, expected.strains);
  EXPECT_EQ(found.outside, expected.outside);
  for (std::size_t f = 0; f < found.fades.size(); ++f) {
    EXPECT_EQ(found.fades[f], static_cast<float>(mean_fade(expected, f)));
  }
}

TEST(LibraryFrames, ExpectTheirError) {
  const TemporaryFolder folder;
  const Basis basis = knowing_basis();
  save_basis(basis, folder / "knowing.safetensors");
  const api::Model model = api::load_model((folder / "knowing.safetensors").string());
  EXPECT_EQ(api::describe(model).knows_error, 1u);
  const std::vector<Pose> poses = turning_poses(basis, kFrames);
  const PoseArrays given(poses);
  Arrays found(basis, kFrames);
  std::vector<float> errors(kFrames, -1);
  found.all.expected_errors = floats_in(errors);
  api::check(bodyopt_evaluate(make_instance(model).get(), &given.all, &found.all));
  Deformer deformer(basis, {.name = "cpu"});
  const ErrorExpectation expectation(basis);
  for (std::size_t f = 0; f < kFrames; ++f) {
    const Evaluation alone = deformer.evaluate({&poses[f], 1});
    EXPECT_EQ(errors[f], static_cast<float>(1e-3 * expectation.of(alone, 0).rms_mm));
    EXPECT_GT(errors[f], 0.0004f);
  }
  // A program of the first version does not know of them.
  found.all.struct_size = offsetof(bodyopt_skin, expected_errors);
  std::fill(errors.begin(), errors.end(), -1.0f);
  api::check(bodyopt_evaluate(make_instance(model).get(), &given.all, &found.all));
  EXPECT_EQ(errors, std::vector<float>(kFrames, -1));
}

TEST(LibraryFrames, ExpectTheErrorOfEveryVertexByItsRegions) {
  const TemporaryFolder folder;
  const Basis basis = knowing_basis();
  save_basis(basis, folder / "knowing.safetensors");
  const api::Model model = api::load_model((folder / "knowing.safetensors").string());
  const std::vector<Pose> poses = turning_poses(basis, kFrames);
  const PoseArrays given(poses);
  Arrays found(basis, kFrames);
  const std::size_t vertices = basis.mesh.output_count();
  std::vector<float> errors(kFrames * vertices, -1);
  found.all.vertex_errors = floats_in(errors);
  api::check(bodyopt_evaluate(make_instance(model).get(), &given.all, &found.all));
  Deformer deformer(basis, {.name = "cpu"});
  const ErrorExpectation expectation(basis);
  for (std::size_t f = 0; f < kFrames; ++f) {
    const Evaluation alone = deformer.evaluate({&poses[f], 1});
    const std::vector<float> solved = RegionShares(basis).carry(expectation.of(alone, 0).region_mm);
    for (std::size_t v = 0; v < vertices; ++v) {
      ASSERT_EQ(errors[f * vertices + v], solved[basis.mesh.output_vertex[v]]) << "frame " << f << ", vertex " << v;
    }
  }
  EXPECT_GT(*std::ranges::max_element(errors), 0.0004f);
}

TEST(LibraryFrames, NameTheFeatureThatLiesOutside) {
  const Basis basis = load_basis(hero());
  const api::Model model = api::load_model(hero());
  std::vector<Pose> poses = turning_poses(basis, 1);
  poses.insert(poses.begin(), bind_pose(basis.skeleton));
  poses[1].joints[1].rotation = axis_angle({0, 1, 0}, 2.5);
  const PoseArrays given(poses);
  Arrays found(basis, poses.size());
  std::vector<float> features(poses.size(), -7);
  found.all.outside_features = floats_in(features);
  std::vector<float> excess(poses.size() * api::describe(model).feature_count, -7);
  found.all.excess = floats_in(excess);
  api::check(bodyopt_evaluate(make_instance(model).get(), &given.all, &found.all));
  Deformer deformer(basis, {.name = "cpu"});
  const Evaluation expected = deformer.evaluate(poses);
  ASSERT_GT(expected.outside[1], 0);
  for (std::size_t f = 0; f < poses.size(); ++f) {
    EXPECT_EQ(features[f], expected.outside[f] > 0 ? static_cast<float>(expected.outside_feature[f]) : -1.0f);
  }
  EXPECT_EQ(excess, expected.excess);
  const std::size_t count = excess.size() / poses.size();
  for (std::size_t f = 0; f < poses.size(); ++f) {
    EXPECT_EQ(std::ranges::max(std::span(excess).subspan(f * count, count)), expected.outside[f]);
  }
  EXPECT_EQ(bodyopt_feature_name(model.get(), expected.outside_feature[1]),
            feature_name(basis, expected.outside_feature[1]));
  EXPECT_EQ(bodyopt_feature_name(model.get(), basis.residual.feature_count()), nullptr);
  EXPECT_EQ(bodyopt_feature_name(nullptr, 0), nullptr);
}

TEST(LibraryFrames, OfAModelThatDoesNotKnowItsErrorAreRefusedBeforeTheyAreWritten) {
  const TemporaryFolder folder;
  const Basis basis = small_basis();
  save_basis(basis, folder / "small.safetensors");
  const api::Model model = api::load_model((folder / "small.safetensors").string());
  EXPECT_EQ(api::describe(model).knows_error, 0u);
  const std::vector<Pose> poses = turning_poses(basis, kFrames);
  const PoseArrays given(poses);
  Arrays found(basis, kFrames);
  std::vector<float> errors(kFrames);
  found.all.expected_errors = floats_in(errors);
  EXPECT_EQ(bodyopt_evaluate(make_instance(model).get(), &given.all, &found.all), BODYOPT_MISMATCH);
  EXPECT_NE(std::string(bodyopt_last_error()).find("trained without shapes"), std::string::npos);
  found.all.expected_errors = {};
  std::vector<float> of_vertices(kFrames * basis.mesh.output_count());
  found.all.vertex_errors = floats_in(of_vertices);
  EXPECT_EQ(bodyopt_evaluate(make_instance(model).get(), &given.all, &found.all), BODYOPT_MISMATCH);
  EXPECT_EQ(found.positions, std::vector<float>(found.positions.size()));
}

TEST(LibraryFrames, AreThoseOfTheDeformer) {
  Deformer deformer(load_basis(hero()), {.name = "cpu"});
  const std::vector<Pose> poses = turning_poses(deformer.basis(), kFrames);
  const Evaluation expected = deformer.evaluate(poses);
  const api::Model model = api::load_model(hero());
  const api::Instance instance = make_instance(model);
  for (const std::size_t gap : {0u, 3u}) {
    Arrays found(deformer.basis(), kFrames);
    const PoseArrays given(poses, gap);
    api::check(bodyopt_evaluate(instance.get(), &given.all, &found.all));
    expect_same(found, expected);
  }
  EXPECT_LT(*std::ranges::min_element(expected.strains), -0.001f);
}

// Interleaved as an engine's vertex buffer has them: position, normal, two numbers of its own.
TEST(LibraryFrames, AreWrittenBetweenOtherNumbers) {
  Deformer deformer(load_basis(hero()), {.name = "cpu"});
  const std::vector<Pose> poses = turning_poses(deformer.basis(), kFrames);
  const Evaluation expected = deformer.evaluate(poses);
  const std::size_t vertices = deformer.basis().mesh.output_count(), vertex = 8, frame = vertex * vertices + 5;
  std::vector<float> buffer(frame * kFrames, -7.0f);
  auto skin = api::make<bodyopt_skin>();
  skin.positions = {buffer.data(), buffer.size() * sizeof(float), vertex * sizeof(float), frame * sizeof(float)};
  skin.normals = {buffer.data() + 3, (buffer.size() - 3) * sizeof(float), vertex * sizeof(float),
                  frame * sizeof(float)};
  const api::Model model = api::load_model(hero());
  const PoseArrays given(poses);
  api::check(bodyopt_evaluate(make_instance(model).get(), &given.all, &skin));
  for (std::size_t f = 0; f < kFrames; ++f) {
    for (std::size_t v = 0; v < vertices; ++v) {
      const float* found = buffer.data() + f * frame + v * vertex;
      for (std::size_t i = 0; i < 3; ++i) {
        ASSERT_EQ(found[i], expected.positions[3 * (f * vertices + v) + i]);
        ASSERT_EQ(found[3 + i], expected.normals[3 * (f * vertices + v) + i]);
      }
      ASSERT_EQ(found[6], -7.0f);
      ASSERT_EQ(found[7], -7.0f);
    }
    for (std::size_t i = vertex * vertices; i < frame; ++i) ASSERT_EQ(buffer[f * frame + i], -7.0f);
  }
}

// What is not wanted is not written, on either side, and changes no bit of what is.
TEST(LibraryFrames, GiveWhatIsWanted) {
  test_device();
  const Basis basis = load_basis(hero());
  const PoseArrays given(turning_poses(basis, kFrames));
  const api::Model model = api::load_model(hero());
  const api::Device device = api::open_device();
  for (const api::Device& where : {std::cref(device), std::cref(kNoDevice)}) {
    const api::Instance instance = make_instance(model, false, where);
    Arrays all(basis, kFrames), some(basis, kFrames);
    some.all.normals = some.all.strains = {};
    for (Arrays* arrays : {&all, &some, &all}) {
      ASSERT_EQ(bodyopt_evaluate(instance.get(), &given.all, &arrays->all), BODYOPT_OK) << bodyopt_last_error();
    }
    EXPECT_EQ(some.positions, all.positions);
    EXPECT_EQ(some.outside, all.outside);
    EXPECT_EQ(some.normals, std::vector<float>(some.normals.size()));
    EXPECT_EQ(some.strains, std::vector<float>(some.strains.size()));
    EXPECT_NE(all.normals, some.normals);
  }
}

TEST(LibraryFrames, DescribeTheCharacter) {
  const Basis basis = load_basis(hero());
  const api::Model model = api::load_model(hero(), hero_dynamics());
  const bodyopt_description found = api::describe(model);
  EXPECT_EQ(found.vertex_count, basis.mesh.output_count());
  EXPECT_EQ(found.joint_count, basis.skeleton.size());
  EXPECT_EQ(found.strain_count, basis.strain.fibre_count());
  EXPECT_EQ(found.control_count, basis.residual.controls.size());
  EXPECT_EQ(found.has_dynamics, 1u);
  EXPECT_EQ(found.frames_per_second, load_dynamics(hero_dynamics(), basis).jiggle.step.frames_per_second);
  for (std::uint32_t j = 0; j < found.joint_count; ++j) {
    EXPECT_EQ(bodyopt_joint_name(model.get(), j), basis.skeleton.joints[j].name);
    EXPECT_EQ(bodyopt_joint_parent(model.get(), j), basis.skeleton.joints[j].parent);
  }
  for (std::uint32_t s = 0; s < found.strain_count; ++s) {
    EXPECT_EQ(bodyopt_strain_name(model.get(), s), basis.strain.names[s]);
  }
  EXPECT_EQ(bodyopt_joint_name(model.get(), found.joint_count), nullptr);
  EXPECT_EQ(bodyopt_control_name(model.get(), found.control_count), nullptr);
  std::vector<std::uint32_t> triangles(3 * found.triangle_count);
  api::check(bodyopt_get_triangles(model.get(), triangles.data(), triangles.size() * sizeof(triangles[0])));
  EXPECT_EQ(triangles, basis.mesh.output_triangles);
  std::vector<double> joints(10 * found.joint_count);
  api::check(bodyopt_get_bind_pose(model.get(), joints.data(), joints.size() * sizeof(joints[0])));
  EXPECT_EQ(joints, PoseArrays({bind_pose(basis.skeleton)}).joints);
}

// A shot in one call, and cut in two by a state that goes through a file.
TEST(LibraryFrames, JiggleGoesOnFromAState) {
  Basis basis = load_basis(hero());
  Dynamics dynamics = load_dynamics(hero_dynamics(), basis);
  Deformer deformer(basis, std::move(dynamics), {}, {.name = "cpu"});
  const std::vector<Pose> poses = turning_poses(basis, kFrames);
  const PoseArrays given(poses);
  const Evaluation expected = deformer.jiggle(poses, given.numbers);
  EXPECT_NE(expected.positions, deformer.evaluate(poses).positions);

  const api::Model model = api::load_model(hero(), hero_dynamics());
  const api::Instance first = make_instance(model, true), second = make_instance(model, true);
  Arrays whole(basis, kFrames);
  api::check(bodyopt_jiggle(first.get(), &given.all, &whole.all));
  expect_same(whole, expected);

  api::check(bodyopt_set_state(first.get(), nullptr));
  PoseArrays head({poses.begin(), poses.begin() + 2}), tail({poses.begin() + 2, poses.end()});
  tail.numbers = {2, 3, 4};
  tail.all.frame_numbers = tail.numbers.data();
  Arrays begin(basis, 2), end(basis, 3);
  api::check(bodyopt_jiggle(first.get(), &head.all, &begin.all));
  bodyopt_state* state = nullptr;
  api::check(bodyopt_get_state(first.get(), &state));
  const TemporaryFolder folder;
  api::check(bodyopt_save_state(first.get(), state, (folder / "a.state").c_str()));
  bodyopt_release_state(state);
  api::check(bodyopt_load_state(second.get(), (folder / "a.state").c_str(), &state));
  const api::State read(state);
  api::check(bodyopt_set_state(second.get(), read.get()));
  api::check(bodyopt_jiggle(second.get(), &tail.all, &end.all));
  EXPECT_EQ(end.positions,
            std::vector<float>(expected.positions.end() - static_cast<std::ptrdiff_t>(end.positions.size()),
                               expected.positions.end()));
}

TEST(LibraryFrames, RunOnTheHostsThreads) {
  const Basis basis = load_basis(hero());
  const std::vector<Pose> poses = turning_poses(basis, kFrames);
  std::size_t calls = 0;
  auto executor = api::make<bodyopt_executor>();
  executor.host = &calls;
  // Two parts, the later first.
  executor.parallel_for = [](void* host, std::size_t count, std::size_t, void (*task)(const void*, size_t, size_t),
                             const void* context) {
    ++*static_cast<std::size_t*>(host);
    if (count > 1) task(context, count / 2, count);
    task(context, 0, count > 1 ? count / 2 : count);
  };
  auto options = api::make<bodyopt_instance_options>();
  options.executor = &executor;
  const api::Model model = api::load_model(hero());
  const api::Instance lent = api::create_instance(model, options), own = make_instance(model);
  Arrays found(basis, kFrames), expected(basis, kFrames);
  const PoseArrays given(poses);
  api::check(bodyopt_evaluate(lent.get(), &given.all, &found.all));
  api::check(bodyopt_evaluate(own.get(), &given.all, &expected.all));
  EXPECT_GT(calls, 0u);
  EXPECT_EQ(found.positions, expected.positions);
  EXPECT_EQ(found.normals, expected.normals);
}

// Two threads, each with an instance, of one model on one device.
TEST(LibraryFrames, AreTheSameFromSeveralThreadsOnADevice) {
  test_device();  // the loader sees the test's device alone
  Deformer deformer(load_basis(hero()), {.name = "cpu"});
  const std::vector<Pose> poses = turning_poses(deformer.basis(), kFrames);
  const Evaluation expected = deformer.evaluate(poses);
  const api::Model model = api::load_model(hero());
  const api::Device device = api::open_device();
  EXPECT_NE(bodyopt_device_name(device.get()), nullptr);
  const PoseArrays given(poses);
  std::vector<Arrays> found(2, Arrays(deformer.basis(), kFrames));
  for (Arrays& arrays : found) arrays = Arrays(deformer.basis(), kFrames);
  {
    std::vector<std::jthread> threads;
    for (Arrays& arrays : found) {
      threads.emplace_back([&] {
        Arrays mine(deformer.basis(), kFrames);
        const api::Instance instance = make_instance(model, false, device);
        for (int repeat = 0; repeat < 5; ++repeat) {
          EXPECT_EQ(bodyopt_evaluate(instance.get(), &given.all, &mine.all), BODYOPT_OK) << bodyopt_last_error();
        }
        arrays.positions = mine.positions;
      });
    }
  }
  EXPECT_EQ(found[0].positions, found[1].positions);
  expect_close(found[0].positions, expected.positions, 1e-5);
}

TEST(LibraryFrames, WithoutCorrectionAreDirectDeltaMush) {
  Deformer deformer(load_basis(hero()), {.name = "cpu"});
  deformer.set_weights({.correction = 0});
  const std::vector<Pose> poses = turning_poses(deformer.basis(), kFrames);
  const api::Model model = api::load_model(hero());
  const api::Instance instance = make_instance(model);
  Arrays with(deformer.basis(), kFrames), without(deformer.basis(), kFrames);
  const PoseArrays given(poses);
  api::check(bodyopt_evaluate(instance.get(), &given.all, &with.all));
  api::check(bodyopt_set_weights(instance.get(), 0, 1));
  api::check(bodyopt_evaluate(instance.get(), &given.all, &without.all));
  EXPECT_EQ(without.positions, deformer.evaluate(poses).positions);
  EXPECT_NE(with.positions, without.positions);
}

}  // namespace frames_test
}  // namespace bodyopt::testing
