#include "runtime/deformer/deformer.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>

#include "runtime/core/error.h"
#include "runtime/core/extent.h"
#include "runtime/cpu/cpu_backend.h"
#include "runtime/cpu/kernels.h"
#include "runtime/deformer/checked_backend.h"
#include "runtime/host/fade.h"
#include "runtime/host/rig.h"
#include "runtime/host/stages.h"
#include "runtime/threads/tbb_executor.h"
#include "runtime/vulkan/backend/device_model.h"
#include "runtime/vulkan/backend/vulkan_backend.h"
#include "runtime/vulkan/device.h"
#include "runtime/vulkan/recording.h"

namespace bodyopt {
namespace {

// `model` outlives the backend.
std::unique_ptr<Backend> on_the_cpu(const std::shared_ptr<const CharacterModel>& model,
                                    const std::optional<JiggleOptions>& jiggle,
                                    const std::shared_ptr<Executor>& threads = nullptr) {
  return make_cpu_backend(model->basis, jiggle ? JiggleModel{&*model->dynamics, *jiggle} : JiggleModel{},
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

// Pose::modifiers, one for each component. A basis without any, such as a lighter level, has nothing to weigh.
std::vector<float> modifier_weights(const Basis& basis, const Pose& pose) {
  const std::size_t count = basis.modifiers.component_count();
  if (count == 0) return {};
  if (!pose.modifiers.empty() && pose.modifiers.size() != count) {
    throw Error(ErrorKind::mismatch, "a pose has " + std::to_string(pose.modifiers.size()) +
                                         " weights of modifiers, the basis has " + std::to_string(count));
  }
  for (const float weight : pose.modifiers) {
    if (!std::isfinite(weight)) throw Error(ErrorKind::mismatch, "a modifier's weight is not a finite number");
  }
  std::vector<float> weights = pose.modifiers;
  weights.resize(count, 0.0f);
  return weights;
}

void check_controls(const Basis& basis, const Pose& pose) {
  const std::size_t controls = basis.residual.controls.size();
  if (!pose.controls.empty() && pose.controls.size() != controls) {
    throw Error(ErrorKind::mismatch, "a pose has " + std::to_string(pose.controls.size()) +
                                         " control values, the basis has " + std::to_string(controls) + " controls");
  }
  for (std::size_t c = 0; c < pose.controls.size(); ++c) {
    if (std::isfinite(pose.controls[c])) continue;
    throw Error(ErrorKind::mismatch, "the control '" + basis.residual.controls[c] + "' is not a finite number");
  }
}

Batch make_batch(const Basis& basis, std::span<const Pose> poses) {
  Batch batch;
  batch.frame_count = static_cast<std::uint32_t>(poses.size());
  const std::size_t controls = basis.residual.controls.size();
  for (const Pose& pose : poses) {
    const RigFrame rig = pose_rig(basis.skeleton, pose);
    batch.skinning.insert(batch.skinning.end(), rig.skinning.begin(), rig.skinning.end());
    batch.origins.insert(batch.origins.end(), {rig.origin[0], rig.origin[1], rig.origin[2], 0.0f});
    batch.joint_features.insert(batch.joint_features.end(), rig.joint_features.begin(), rig.joint_features.end());
    if (basis.modifiers.turn_joints()) {
      batch.learned_skinning.insert(batch.learned_skinning.end(), rig.learned_skinning.begin(),
                                    rig.learned_skinning.end());
    }
    batch.joints.insert(batch.joints.end(), rig.joints.begin(), rig.joints.end());
    const std::vector<float> fades = region_fades(basis.residual, rig.joint_features);
    batch.fades.insert(batch.fades.end(), fades.begin(), fades.end());
    check_controls(basis, pose);
    std::vector<float> values = pose.controls;
    values.resize(controls, 0.0f);
    batch.controls.insert(batch.controls.end(), values.begin(), values.end());
    const std::vector<float> weights = modifier_weights(basis, pose);
    batch.modifiers.insert(batch.modifiers.end(), weights.begin(), weights.end());
  }
  return batch;
}

// Frame-major V x 3 in runtime order to O x 3 in output order, appended.
void append_output(const MeshTable& mesh, std::span<const float> values, std::vector<float>& out) {
  if (values.empty()) return;
  const std::size_t at = out.size(), numbers = 3 * std::size_t{mesh.output_count()};
  out.resize(at + numbers * (values.size() / (3 * std::size_t{mesh.vertex_count()})));
  cpu::output_place(mesh, values, 3 * sizeof(float), numbers * sizeof(float),
                    reinterpret_cast<std::byte*>(out.data() + at));
}

// The same into the caller's memory, frames `begin` and after.
void place_output(const MeshTable& mesh, std::span<const float> values, const PlacedVertices& place,
                  std::size_t begin) {
  if (place.data == nullptr || values.empty()) return;
  cpu::output_place(mesh, values, place.element_stride, place.frame_stride, place.data + begin * place.frame_stride);
}

// Of each of `frames` frames the feature that lies furthest outside its trained range.
void append_outside(const BatchResult& result, std::size_t frames, Evaluation& evaluation) {
  const std::size_t features = result.excess.size() / std::max<std::size_t>(1, frames);
  for (std::size_t f = 0; f < frames; ++f) {
    const auto begin = result.excess.begin() + static_cast<std::ptrdiff_t>(f * features);
    const auto worst = std::max_element(begin, begin + static_cast<std::ptrdiff_t>(features));
    evaluation.outside.push_back(features > 0 ? *worst : 0.0f);
    evaluation.outside_feature.push_back(static_cast<std::uint32_t>(worst - begin));
  }
}

void append_fades(const Basis& basis, const Batch& batch, Evaluation& evaluation) {
  evaluation.fades.insert(evaluation.fades.end(), batch.fades.begin(), batch.fades.end());
  const std::vector<std::uint32_t> joints = feature_joints(basis.skeleton);
  for (std::size_t f = 0; f < batch.frame_count; ++f) {
    const std::size_t stride = 9 * joints.size();
    const int joint = fading_joint(basis.residual, std::span(batch.joint_features).subspan(f * stride, stride));
    evaluation.fading_joint.push_back(joint < 0 ? -1 : static_cast<int>(joints[static_cast<std::size_t>(joint)]));
  }
}

void check_state(const JiggleState& state, const Basis& basis, const Dynamics* dynamics) {
  const auto refuse = [](const std::string& what) {
    throw Error(ErrorKind::mismatch, "the state of the jiggle " + what + ": it is of another character, or damaged");
  };
  if (dynamics == nullptr) refuse("was given to a character without dynamics");
  const auto check = [&](const auto& values, std::size_t count, const char* name) {
    if (values.size() != count) {
      refuse("has " + std::to_string(values.size()) + " numbers of '" + name + "', expected " + std::to_string(count));
    }
    for (const auto value : values) {
      if (!std::isfinite(value)) refuse(std::string("has a number of '") + name + "' that is not finite");
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
  const std::vector<std::uint32_t> joints = feature_joints(basis.skeleton);
  if (feature < 9 * joints.size()) return "joint " + basis.skeleton.joints[joints[feature / 9]].name;
  const std::size_t strain = feature - 9 * joints.size();
  if (strain < basis.strain.fibre_count()) return "strain " + basis.strain.names[strain];
  return "control " + basis.residual.controls.at(strain - basis.strain.fibre_count());
}

Deformer::Deformer(std::shared_ptr<const CharacterModel> model, const std::optional<JiggleOptions>& jiggle,
                   std::unique_ptr<Backend> backend)
    : model_(std::move(model)),
      jiggles_(jiggle.has_value()),
      options_(jiggle.value_or(JiggleOptions{})),
      size_(box_diagonal(basis().mesh.rest)),
      backend_(std::move(backend)) {
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

// The rest coefficients come from the kernels that will run, so that rest gives rest exactly.
void Deformer::set_rest() {
  const Pose rest = bind_pose(basis().skeleton);
  backend_->set_rest_coefficients(std::vector<float>(basis().residual.coefficient_count(), 0.0f));
  backend_->set_rest_coefficients(backend_->run(make_batch(basis(), {&rest, 1})).coefficients);
}

void Deformer::set_weights(const Weights& weights) {
  backend_->set_weights(weights);
  const bool other_rest = weights.kernels != weights_.kernels;
  weights_ = weights;
  if (other_rest) set_rest();
}

Deformer::~Deformer() = default;

std::string Deformer::device_name() const { return backend_->name(); }

Evaluation Deformer::evaluate(std::span<const Pose> poses) { return run(poses, {}, {}); }

Evaluation Deformer::evaluate_on_device(std::span<const Pose> poses) {
  require_one_batch(poses);
  return run(poses, {}, {.stays_on_device = true});
}

Evaluation Deformer::jiggle(std::span<const Pose> poses, std::span<const int> frames) {
  return step(poses, frames, {});
}

Evaluation Deformer::jiggle_on_device(std::span<const Pose> poses, std::span<const int> frames) {
  require_one_batch(poses);
  return step(poses, frames, {.stays_on_device = true});
}

Evaluation Deformer::evaluate_into(const SkinPlace& place, std::span<const Pose> poses) {
  return run(poses, {}, {.place = &place});
}

Evaluation Deformer::jiggle_into(const SkinPlace& place, std::span<const Pose> poses, std::span<const int> frames) {
  return step(poses, frames, {.place = &place});
}

void Deformer::require_one_batch(std::span<const Pose> poses) const {
  if (poses.size() <= batch_limit()) return;
  throw Error(ErrorKind::usage, std::to_string(poses.size()) + " poses at once are more than the " +
                                    std::to_string(batch_limit()) + " that fit on '" + device_name() + "'");
}

Evaluation Deformer::step(std::span<const Pose> poses, std::span<const int> frames, const Destination& to) {
  if (!jiggles_) throw Error(ErrorKind::usage, "the character was loaded without dynamics: it cannot jiggle");
  if (frames.size() != poses.size()) {
    throw Error(ErrorKind::usage,
                std::to_string(poses.size()) + " poses have " + std::to_string(frames.size()) + " frame numbers");
  }
  // A batch that fails leaves the motion as it was; only of several some may have been stepped, and the motion of
  // before is fetched from the device for that.
  const bool several = poses.size() > batch_limit();
  const JiggleState before = several ? state() : state_;
  try {
    return run(poses, frames, to);
  } catch (...) {
    if (several) {
      set_state(before);
    } else {
      state_ = before;
    }
    throw;
  }
}

JiggleState Deformer::state() const {
  JiggleState state = state_;
  if (jiggles_ && state.known > 0) state.motion = backend_->motion();
  return state;
}

void Deformer::set_state(const JiggleState& state) {
  if (state.known > 0) check_state(state, basis(), dynamics());
  state_ = state;
  if (jiggles_ && state.known > 0) backend_->set_motion(state.motion);
  state_.motion = {};
}

Evaluation Deformer::run(std::span<const Pose> poses, std::span<const int> frames, const Destination& to) {
  Evaluation evaluation;
  const std::size_t limit = std::max<std::size_t>(1, backend_->batch_limit());
  for (std::size_t begin = 0; begin < poses.size(); begin += limit) {
    const auto part = poses.subspan(begin, std::min(limit, poses.size() - begin));
    const auto start = std::chrono::steady_clock::now();
    Batch batch = make_batch(basis(), part);
    batch.stays_on_device = to.stays_on_device;
    batch.wants_normals = to.place != nullptr ? to.place->normals.data != nullptr : wants_normals_;
    if (!frames.empty()) batch.jiggle = plan(batch, frames.subspan(begin, part.size()));
    evaluation.stage_seconds[name_of(Stage::rig)] +=
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const BatchResult result = backend_->run(batch);
    if (to.place != nullptr) {
      place_output(basis().mesh, result.positions, to.place->positions, begin);
      place_output(basis().mesh, result.normals, to.place->normals, begin);
    } else {
      append_output(basis().mesh, result.positions, evaluation.positions);
      append_output(basis().mesh, result.normals, evaluation.normals);
    }
    evaluation.strains.insert(evaluation.strains.end(), result.strains.begin(), result.strains.end());
    append_outside(result, part.size(), evaluation);
    append_fades(basis(), batch, evaluation);
    for (const JiggleFrame& frame : batch.jiggle) evaluation.starts.push_back(frame.start);
    for (const auto& [stage, seconds] : result.stage_seconds) evaluation.stage_seconds[stage] += seconds;
  }
  return evaluation;
}

void Deformer::record(const Pose& pose, std::optional<int> frame, const vulkan::Recording& recording) {
  if (frame && !jiggles_) throw Error(ErrorKind::usage, "the character was loaded without dynamics: it cannot jiggle");
  Batch batch = make_batch(basis(), {&pose, 1});
  batch.wants_normals = recording.normals.buffer != VK_NULL_HANDLE;
  const JiggleState before = state_;
  try {
    if (frame) batch.jiggle = plan(batch, {&*frame, 1});
    backend_->record(batch, recording);
  } catch (...) {
    state_ = before;
    throw;
  }
}

std::vector<JiggleFrame> Deformer::plan(const Batch& batch, std::span<const int> frames) {
  std::vector<JiggleFrame> plans;
  const std::size_t numbers = 3 * basis().skeleton.size();
  for (std::size_t f = 0; f < frames.size(); ++f) {
    const double origin[3] = {batch.origins[4 * f], batch.origins[4 * f + 1], batch.origins[4 * f + 2]};
    plans.push_back(plan_frame(frames[f], std::span(batch.joints).subspan(f * numbers, numbers), origin, size_,
                               dynamics()->jiggle.step, options_, state_));
  }
  return plans;
}

}  // namespace bodyopt
