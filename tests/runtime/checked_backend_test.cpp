// The check finds what is wrong where it is wrong. Both sides are the CPU, one with tables that are spoilt in a place.
#include "runtime/deformer/checked_backend.h"

#include <functional>

#include "runtime/core/error.h"
#include "runtime/cpu/cpu_backend.h"
#include "runtime/deformer/deformer.h"
#include "runtime/deformer/evaluate_together.h"
#include "runtime/vulkan/backend/device_model.h"
#include "runtime/vulkan/backend/vulkan_backend.h"
#include "tests/support/gpu_fixture.h"
#include "tests/support/paths.h"
#include "tests/support/random_basis.h"

namespace bodyopt::testing {
namespace checked_backend_test {

// Outlives its backends.
struct Sides {
  Sides(const std::function<void(Basis&)>& spoil) {
    Basis basis = random_basis(20, 70);
    model = model_of(basis);
    spoilt = basis;
    spoil(spoilt);
    checked = make_checked_backend(model, make_cpu_backend(model_of(spoilt)), make_cpu_backend(model));
  }

  std::shared_ptr<const CharacterModel> model;
  Basis spoilt;
  std::unique_ptr<Backend> checked;
};

// What the check says of three frames; "" where it finds nothing.
std::string said_of(const std::function<void(Basis&)>& spoil) {
  const Sides sides(spoil);
  try {
    const Batch batch = random_batch(sides.model->basis, 3);
    EXPECT_EQ(sides.checked->run(batch).positions, make_cpu_backend(model_of(sides.spoilt))->run(batch).positions);
    return "";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::device);
    return error.what();
  }
}

void expect_says(const std::function<void(Basis&)>& spoil, std::initializer_list<const char*> texts) {
  const std::string said = said_of(spoil);
  for (const char* text : texts) EXPECT_NE(said.find(text), std::string::npos) << said << "\ndoes not say: " << text;
}

TEST(CheckedBackend, FindsNothingInEqualTables) {
  EXPECT_EQ(said_of([](Basis&) {}), "");
}

TEST(CheckedBackend, NamesStageFrameVertexValuesAndTolerance) {
  expect_says([](Basis& b) { b.strain.rest_length[7] *= 1.01f; },
              {"stage 'strain'", "frame 0", "fibre muscle/7", "tolerance"});
  expect_says([](Basis& b) { b.residual.weights[0] += 1; }, {"stage 'residual'", "coefficient 0"});
  // The blend is seen in the skin first.
  expect_says([](Basis& b) { b.ddm.vertices[100].offset_x += 0.01f; },
              {"stage 'pose'", "frame 0", "vertex 100", "the device has", "the CPU"});
  expect_says([](Basis& b) { std::swap(b.mesh.triangles[0], b.mesh.triangles[1]); }, {"stage 'output'", "vertex"});
  expect_says([](Basis& b) { b.ddm.vertices[9].offset_y = std::nanf(""); }, {"stage 'pose'", "vertex 9", "nan"});
}

// A backend that gives something else than it should.
class SpoiltBackend final : public Backend {
 public:
  using SpoilResult = std::function<void(BatchResult&)>;
  using SpoilMotion = std::function<void(NodeMotion&)>;
  SpoiltBackend(std::unique_ptr<Backend> backend, SpoilResult result, SpoilMotion motion)
      : backend_(std::move(backend)), spoil_result_(std::move(result)), spoil_motion_(std::move(motion)) {}

  std::string name() const override { return backend_->name(); }
  std::uint32_t batch_limit() const override { return backend_->batch_limit(); }
  const BatchResult& run(const Batch& batch) override {
    result_ = backend_->run(batch);
    spoil_result_(result_);
    return result_;
  }
  void set_rest_coefficients(std::span<const float> values) override { backend_->set_rest_coefficients(values); }
  void set_weights(const Weights& weights) override { backend_->set_weights(weights); }
  void set_motion(const NodeMotion& motion) override { backend_->set_motion(motion); }
  NodeMotion motion() const override {
    NodeMotion motion = backend_->motion();
    spoil_motion_(motion);
    return motion;
  }

 private:
  std::unique_ptr<Backend> backend_;
  SpoilResult spoil_result_;
  SpoilMotion spoil_motion_;
  BatchResult result_;
};

// What the check says of three frames of a jiggle, the first of which is the call's frame 64.
std::string said_of_jiggle(const SpoiltBackend::SpoilResult& result, const SpoiltBackend::SpoilMotion& motion) {
  const std::string hero = kSourceFolder + "/tests/old_files/hero";
  const Basis basis = load_basis(hero + ".safetensors");
  const auto model =
      std::make_shared<const CharacterModel>(basis, load_dynamics(hero + ".dynamics.safetensors", basis));
  const auto cpu = [&] { return make_cpu_backend(model, JiggleModel{&*model->dynamics, {}}); };
  const auto checked = make_checked_backend(model, std::make_unique<SpoiltBackend>(cpu(), result, motion), cpu());
  const std::vector<Pose> poses(3, bind_pose(basis.skeleton));
  CallMemory memory(basis.skeleton);
  Batch batch = make_batch(basis, poses, memory);
  batch.first_frame = 64;
  JiggleState state;
  for (int frame = 1; frame <= 3; ++frame) {
    batch.jiggle.push_back(plan_frame(frame, std::span(batch.joints).first(3 * basis.skeleton.size()), {}, 1,
                                      model->dynamics->jiggle.step, {}, state));
  }
  try {
    checked->run(batch);
    return "";
  } catch (const Error& error) {
    return error.what();
  }
}

TEST(CheckedBackend, CountsFramesOfTheCall) {
  const auto nothing = [](auto&) {};
  EXPECT_EQ(said_of_jiggle(nothing, nothing), "");
  const auto expect = [](const std::string& said, const std::string& text) {
    EXPECT_NE(said.find(text), std::string::npos) << said << "\ndoes not say: " << text;
  };
  expect(said_of_jiggle([](BatchResult& r) { r.posed[r.posed.size() / 3 * 2] += 1; }, nothing),
         "stage 'pose', frame 66 of the call, vertex");
  expect(said_of_jiggle([](BatchResult& r) { r.positions[r.positions.size() / 3] += 1; }, nothing),
         "stage 'jiggle', frame 65 of the call, vertex");
  // The motion is that after the last frame.
  expect(said_of_jiggle(nothing, [](NodeMotion& m) { m.nodes[4] += 1; }),
         "stage 'diffuse', frame 66 of the call, node 1");
  expect(said_of_jiggle(nothing, [](NodeMotion& m) { m.displacement[7] += 1; }),
         "stage 'jiggle', frame 66 of the call, node 2");
}

TEST(CheckedBackend, PassesADevice) {
  const Sides sides([](Basis&) {});
  const auto model = model_of(sides.model->basis);
  Sides gpu([](Basis&) {});
  gpu.checked = make_checked_backend(
      model, make_vulkan_backend(std::make_shared<const vulkan::DeviceModel>(open_test_device(), model)),
      make_cpu_backend(model));
  const Batch batch = random_batch(model->basis, 3);
  BatchResult result;
  EXPECT_NO_THROW(result = gpu.checked->run(batch));
  EXPECT_EQ(result.posed, result.positions);
}

// What was compared does not go on to where a skin that stays on the device is not expected.
TEST(CheckedBackend, GivesNoSkinThatStaysOnTheDevice) {
  const Basis basis = load_basis(kSourceFolder + "/tests/old_files/hero.safetensors");
  const auto model = std::make_shared<const vulkan::DeviceModel>(open_test_device(), model_of(basis));
  Deformer deformer(model, std::nullopt, true);
  const Pose pose = bind_pose(basis.skeleton);
  Evaluation evaluation;
  DeformerCall call{.deformer = &deformer, .poses = {&pose, 1}, .evaluation = &evaluation, .stays_on_device = true};
  evaluate_together({&call, 1});
  EXPECT_EQ(call.error, nullptr);
  EXPECT_TRUE(evaluation.positions.empty() && evaluation.normals.empty());
  EXPECT_FALSE(evaluation.strains.empty());
}

TEST(CheckedBackend, NeedsADevice) {
  EXPECT_THROW(
      Deformer(load_basis(kSourceFolder + "/tests/old_files/hero.safetensors"), {.name = "cpu", .check = true}), Error);
}

}  // namespace checked_backend_test
}  // namespace bodyopt::testing
