#include "runtime/deformer/deformer.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "runtime/core/error.h"
#include "runtime/core/extent.h"
#include "runtime/core/text.h"
#include "runtime/cpu/cpu_backend.h"
#include "runtime/deformer/checked_backend.h"
#include "runtime/deformer/drawn_backend.h"
#include "runtime/deformer/evaluate_together.h"
#include "runtime/host/backend.h"
#include "runtime/host/character_model.h"
#include "runtime/host/device_choice.h"
#include "runtime/host/rig.h"
#include "runtime/threads/tbb_executor.h"
#include "runtime/vulkan/backend/device_model.h"
#include "runtime/vulkan/backend/vulkan_backend.h"
#include "runtime/vulkan/commands.h"
#include "runtime/vulkan/device.h"

namespace bodyopt {
namespace {

std::unique_ptr<Backend> on_the_cpu(const std::shared_ptr<const CharacterModel>& model,
                                    const std::optional<JiggleOptions>& jiggle,
                                    const std::shared_ptr<Executor>& threads = nullptr) {
  return make_cpu_backend(model, jiggle ? JiggleModel{&*model->dynamics, *jiggle} : JiggleModel{},
                          threads ? threads : make_tbb_executor());
}

std::unique_ptr<Backend> on_a_device(const std::shared_ptr<const vulkan::DeviceModel>& model,
                                     const std::optional<JiggleOptions>& jiggle, bool check) {
  std::unique_ptr<Backend> device = make_vulkan_backend(model, jiggle);
  if (!check) return device;
  return make_checked_backend(model->shared_model(), std::move(device), on_the_cpu(model->shared_model(), jiggle));
}

// `model` outlives the backend.
std::unique_ptr<Backend> make_backend(const std::shared_ptr<const CharacterModel>& model,
                                      const std::optional<JiggleOptions>& jiggle, const DeviceChoice& choice) {
  const bool on_cpu = choice.name == "cpu" || (choice.name == "auto" && !choice.require_device && !has_gpu());
  if (choice.name == "cpu" && choice.require_device) {
    throw Error(ErrorKind::device, "the device 'cpu' was asked for together with a required Vulkan device");
  }
  if (on_cpu && choice.check) {
    throw Error(ErrorKind::device,
                "a check compares a Vulkan device with the CPU, but the CPU was chosen: name a device");
  }
  if (on_cpu) return on_the_cpu(model, jiggle, choice.executor);
  const auto device = std::make_shared<const vulkan::Device>(choice);
  return on_a_device(std::make_shared<const vulkan::DeviceModel>(device, model), jiggle, choice.check);
}

// Throws Error(usage) where numbers would grow without bound.
JiggleOptions checked_options(const std::optional<JiggleOptions>& jiggle) {
  if (!jiggle) return {};
  if (const std::string problem = problem_of_gravity_change(jiggle->gravity_change); !problem.empty()) {
    throw Error(ErrorKind::usage, "the change of gravity ", problem);
  }
  return *jiggle;
}

void check_weight(float weight, const char* name) {
  if (std::abs(weight) <= kMostWeight) return;
  throw Error(ErrorKind::usage, "the weight of the ", name, " is ", weight, ", expected a finite number, of ",
              std::lround(kMostWeight), " at most either way");
}

void check_state(const JiggleState& state, const Basis& basis, const Dynamics* dynamics) {
  const auto refuse = [](const auto&... what) {
    throw Error(ErrorKind::mismatch, "the state of the jiggle ", what..., ": it is of another character, or damaged");
  };
  if (dynamics == nullptr) refuse("was given to a character without dynamics");
  const auto check = [&](const auto& values, std::size_t count, const char* name) {
    if (values.size() != count) refuse("has ", values.size(), " numbers of '", name, "', expected ", count);
    for (const auto value : values) {
      if (!std::isfinite(value)) refuse("has a number of '", name, "' that is not finite");
    }
  };
  check(state.joints, 3 * basis.skeleton.size(), "joints");
  check(state.joint_velocity, 3 * basis.skeleton.size(), "joint_velocity");
  check(std::span(state.origin), 3, "origin");
  const std::size_t numbers = dynamics->tets.nodes.size();
  check(state.motion.displacement, numbers, "displacement");
  check(state.motion.velocity, numbers, "velocity");
  check(state.motion.nodes, numbers, "nodes");
  check(state.motion.node_velocity, numbers, "node_velocity");
}

}  // namespace

double mean_fade(const Evaluation& evaluation, std::size_t k) {
  const std::size_t regions = evaluation.fades.size() / std::max<std::size_t>(1, evaluation.fading_joint.size());
  if (regions == 0) return 1;
  const auto begin = evaluation.fades.begin() + static_cast<std::ptrdiff_t>(k * regions);
  return std::accumulate(begin, begin + static_cast<std::ptrdiff_t>(regions), 0.0) / static_cast<double>(regions);
}

std::string feature_name(const Basis& basis, std::uint32_t feature) {
  const std::vector<JointFeatures> joints = joint_features_of(basis.skeleton);
  if (feature < 9 * joints.size()) {
    const JointFeatures& of = joints[feature / 9];
    return (of.per_metre > 0 ? "place of joint " : "joint ") + basis.skeleton.joints[of.joint].name;
  }
  const std::size_t strain = feature - 9 * joints.size();
  if (strain < basis.strain.fibre_count()) return "strain " + basis.strain.names[strain];
  return "control " + basis.residual.controls.at(strain - basis.strain.fibre_count());
}

std::string outside_text(const Basis& basis, std::uint32_t feature, float by) {
  const std::vector<JointFeatures> joints = joint_features_of(basis.skeleton);
  const std::size_t joint_count = 9 * joints.size();
  const auto in = [](double value, const char* unit) { return formatted("%.1f %s", value, unit); };
  if (feature < joint_count && joints[feature / 9].per_metre > 0) return in(1000 * double{by}, "mm");
  if (feature < joint_count) return in(double{by}, "degrees");
  if (feature < joint_count + basis.strain.fibre_count()) return in(100 * double{by}, "% of its length");
  return in(100 * double{by}, "%");
}

Deformer::Deformer(std::shared_ptr<const CharacterModel> model, const std::optional<JiggleOptions>& jiggle,
                   std::unique_ptr<Backend> backend)
    : model_(std::move(model)),
      jiggles_(jiggle.has_value()),
      options_(checked_options(jiggle)),
      size_(box_diagonal(basis().mesh.rest)),
      backend_(std::move(backend)),
      memory_(std::make_unique<CallMemory>(basis().skeleton)) {
  set_rest();
}

Deformer::Deformer(Basis basis, const DeviceChoice& choice)
    : Deformer(make_character_model(std::move(basis)), {}, choice) {}

Deformer::Deformer(Basis basis, Dynamics dynamics, const JiggleOptions& options, const DeviceChoice& choice)
    : Deformer(make_character_model(std::move(basis), std::move(dynamics)), options, choice) {}

Deformer::Deformer(std::shared_ptr<const CharacterModel> model, const std::optional<JiggleOptions>& jiggle,
                   const DeviceChoice& choice)
    : Deformer(model, jiggle, make_backend(model, jiggle, choice)) {}

Deformer::Deformer(std::shared_ptr<const vulkan::DeviceModel> model, const std::optional<JiggleOptions>& jiggle,
                   bool check)
    : Deformer(model->shared_model(), jiggle, on_a_device(model, jiggle, check)) {}

Deformer::Deformer(const std::shared_ptr<const CharacterModel>& model, std::shared_ptr<const vulkan::Device> drawn_on,
                   const std::optional<JiggleOptions>& jiggle)
    : Deformer(model, jiggle,
               make_drawn_backend(on_the_cpu(model, jiggle), std::move(drawn_on),
                                  model->basis.mesh.rest.size() * sizeof(float))) {}

// The rest coefficients, which must be zero before, come from the kernels that will run, so that rest gives rest
// exactly.
void Deformer::set_rest() {
  const Pose rest = bind_pose(basis().skeleton);
  backend_->set_rest_coefficients(backend_->run(make_batch(basis(), {&rest, 1}, *memory_)).coefficients);
}

void Deformer::set_weights(const Weights& weights) {
  check_weight(weights.correction, "correction");
  check_weight(weights.jiggle, "jiggle");
  backend_->set_weights(weights);
  const bool other_rest = weights.kernels != weights_.kernels;
  weights_ = weights;
  if (!other_rest) return;
  backend_->set_rest_coefficients(std::vector<float>(basis().residual.coefficient_count(), 0.0f));
  set_rest();
}

Deformer::~Deformer() = default;

std::string Deformer::device_name() const { return backend_->name(); }
DeviceSkin Deformer::device_skin() const { return backend_->device_skin(); }
std::uint32_t Deformer::batch_limit() const { return backend_->batch_limit(); }
std::uint32_t Deformer::largest_batch() const { return backend_->largest_batch(); }
Executor& Deformer::threads() const { return backend_->threads(); }
void Deformer::forget_recorded_buffers() { backend_->forget_recorded_buffers(); }
const Basis& Deformer::basis() const { return model_->basis; }
const Dynamics* Deformer::dynamics() const { return jiggles_ ? &*model_->dynamics : nullptr; }

Evaluation Deformer::evaluate(std::span<const Pose> poses) { return run({.deformer = this, .poses = poses}); }

Evaluation Deformer::jiggle(std::span<const Pose> poses, std::span<const int> frames) {
  return run({.deformer = this, .poses = poses, .frames = frames});
}

Evaluation Deformer::run(DeformerCall call) {
  Evaluation evaluation;
  call.evaluation = &evaluation;
  evaluate_together({&call, 1});
  if (call.error) std::rethrow_exception(call.error);
  return evaluation;
}

void Deformer::require_one_batch(std::span<const Pose> poses) const {
  if (poses.size() <= largest_batch()) return;
  throw Error(ErrorKind::usage, poses.size(), " poses at once are more than the ", largest_batch(), " that fit on '",
              device_name(), "'");
}

void Deformer::require_tangents() const {
  if (!model_->tangents.vertices.empty()) return;
  throw Error(ErrorKind::usage, "tangents are asked for, and the character was loaded without texture coordinates");
}

JiggleState Deformer::state() const {
  JiggleState state = state_;
  if (jiggles_ && state.known > 0) state.motion = backend_->motion();
  return state;
}

void Deformer::require_own(const JiggleState& state) const {
  if (state.known > 0) check_state(state, basis(), dynamics());
}

void Deformer::set_state(const JiggleState& state) {
  require_own(state);
  state_ = state;
  if (jiggles_ && state.known > 0) backend_->set_motion(state.motion);
  state_.motion = {};
}

void Deformer::record(std::span<const Pose> poses, std::optional<std::span<const int>> frames,
                      const vulkan::Recording& recording) {
  require_one_batch(poses);
  if (frames && !jiggles_) throw Error(ErrorKind::usage, "the character was loaded without dynamics: it cannot jiggle");
  Batch& batch = make_batch(basis(), poses, *memory_);
  batch.wants_normals = recording.normals.buffer != VK_NULL_HANDLE;
  batch.wants_tangents = recording.tangents.buffer != VK_NULL_HANDLE;
  if (batch.wants_tangents) require_tangents();
  memory_->before = state_;
  try {
    if (frames) plan(*frames, batch);
    backend_->record(batch, recording);
  } catch (...) {
    state_ = memory_->before;
    throw;
  }
}

void Deformer::plan(std::span<const int> frames, Batch& batch) {
  const std::size_t numbers = 3 * basis().skeleton.size();
  for (std::size_t f = 0; f < frames.size(); ++f) {
    const double origin[3] = {batch.origins[4 * f], batch.origins[4 * f + 1], batch.origins[4 * f + 2]};
    batch.jiggle.push_back(plan_frame(frames[f], std::span(batch.joints).subspan(f * numbers, numbers), origin, size_,
                                      dynamics()->jiggle.step, options_, state_));
  }
}

}  // namespace bodyopt
