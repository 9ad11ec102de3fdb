#include "runtime/deformer/evaluate_together.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <numbers>
#include <utility>

#include "runtime/core/error.h"
#include "runtime/core/executor.h"
#include "runtime/core/stopwatch.h"
#include "runtime/cpu/kernels.h"
#include "runtime/deformer/deformer.h"
#include "runtime/host/fade.h"
#include "runtime/host/rig.h"
#include "runtime/host/stages.h"
#include "runtime/vulkan/commands.h"

namespace bodyopt {
namespace {

// Output vertices that a thread places at a time.
constexpr std::size_t kPartOutputs = 1024;

// F x V x 3 in runtime order into the caller's memory in output order, frames `begin` and after.
void place_output(Executor& threads, const MeshTable& mesh, std::span<const float> values, const PlacedVertices& place,
                  std::size_t begin) {
  if (place.data == nullptr || values.empty()) return;
  const std::size_t numbers = 3 * std::size_t{mesh.vertex_count()};
  parallel_pieces(threads, values.size() / numbers, mesh.output_count(), kPartOutputs,
                  [&](std::size_t f, std::size_t first, std::size_t count) {
                    cpu::output_place(std::span(mesh.output_vertex).subspan(first, count),
                                      values.subspan(f * numbers, numbers), place.element_stride,
                                      place.data + (begin + f) * place.frame_stride + first * place.element_stride);
                  });
}

// Appends output vertices: F x O x 3.
void append_output(Executor& threads, const MeshTable& mesh, std::span<const float> values, std::vector<float>& out) {
  if (values.empty()) return;
  const std::size_t at = out.size(), numbers = 3 * std::size_t{mesh.output_count()};
  out.resize(at + numbers * (values.size() / (3 * std::size_t{mesh.vertex_count()})));
  place_output(threads, mesh, values,
               {reinterpret_cast<std::byte*>(out.data() + at), 3 * sizeof(float), numbers * sizeof(float)}, 0);
}

// F x O x 4 into the caller's memory, frames `begin` and after.
void place_tangents(Executor& threads, std::span<const float> tangents, std::size_t outputs,
                    const PlacedVertices& place, std::size_t begin) {
  if (tangents.empty()) return;
  parallel_pieces(threads, tangents.size() / (4 * outputs), outputs, kPartOutputs,
                  [&](std::size_t f, std::size_t first, std::size_t count) {
                    std::byte* to = place.data + (begin + f) * place.frame_stride + first * place.element_stride;
                    for (std::size_t o = first; o < first + count; ++o, to += place.element_stride) {
                      std::memcpy(to, &tangents[4 * (f * outputs + o)], 4 * sizeof(float));
                    }
                  });
}

// Returns how far a feature lies outside its range, as Evaluation::outside_by. `excess`: of all features, in standard
// deviations.
float outside_by(const Basis& basis, const std::vector<JointFeatures>& joints, const float* excess,
                 std::size_t feature) {
  const std::vector<FeatureRange>& ranges = basis.residual.features;
  const auto by = [&](std::size_t k) { return excess[k] > 0 ? excess[k] / ranges[k].inverse_scale : 0.0f; };
  const std::size_t joint = feature / 9;
  if (joint >= joints.size()) return by(feature);
  float squares = 0;
  for (std::size_t k = 9 * joint; k < 9 * (joint + 1); ++k) squares += by(k) * by(k);
  if (joints[joint].per_metre > 0) return std::sqrt(squares) / static_cast<float>(joints[joint].per_metre);
  // Rotations that are an angle t apart differ by 2 sqrt(2) sin(t / 2) as matrices.
  const float half_angle = std::asin(std::min(1.0f, std::sqrt(squares / 8)));
  return 360 * std::numbers::inv_pi_v<float> * half_angle;
}

// Appends the feature that lies furthest outside its trained range, for each of `frames` frames.
void append_outside(const Basis& basis, const std::vector<JointFeatures>& joints, const BatchResult& result,
                    std::size_t frames, Evaluation& evaluation) {
  const std::size_t features = result.excess.size() / std::max<std::size_t>(1, frames);
  evaluation.excess.insert(evaluation.excess.end(), result.excess.begin(), result.excess.end());
  for (std::size_t f = 0; f < frames; ++f) {
    const auto begin = result.excess.begin() + static_cast<std::ptrdiff_t>(f * features);
    const auto worst = std::max_element(begin, begin + static_cast<std::ptrdiff_t>(features));
    evaluation.outside.push_back(features > 0 ? *worst : 0.0f);
    evaluation.outside_feature.push_back(static_cast<std::uint32_t>(worst - begin));
    evaluation.outside_by.push_back(
        features > 0 ? outside_by(basis, joints, &*begin, static_cast<std::size_t>(worst - begin)) : 0.0f);
  }
}

void append_fades(const Basis& basis, CallMemory& memory, Evaluation& evaluation) {
  const Batch& batch = memory.batch;
  evaluation.fades.insert(evaluation.fades.end(), batch.fades.begin(), batch.fades.end());
  const std::vector<JointFeatures>& joints = memory.rig.features();
  for (std::size_t f = 0; f < batch.frame_count; ++f) {
    const std::size_t stride = 9 * joints.size();
    memory.off =
        joints_off(basis.residual, std::span(batch.joint_features).subspan(f * stride, stride), std::move(memory.off));
    const int joint = fading_joint(basis.residual, memory.off, memory.taken);
    evaluation.fading_joint.push_back(joint < 0 ? -1 : static_cast<int>(joints[static_cast<std::size_t>(joint)].joint));
  }
}

// Appends the values, and zeros after them, so that they are `count`.
void append_padded(const std::vector<float>& values, std::size_t count, std::vector<float>& to) {
  const std::size_t end = to.size() + count;
  to.insert(to.end(), values.begin(), values.end());
  to.resize(end, 0.0f);
}

// Pose::modifiers, one for each component. A basis without any, such as a lighter level, has nothing to weigh.
void append_modifier_weights(const Basis& basis, const Pose& pose, std::vector<float>& weights) {
  const std::size_t count = basis.modifiers.component_count();
  if (count == 0) return;
  if (!pose.modifiers.empty() && pose.modifiers.size() != count) {
    throw Error(ErrorKind::mismatch, "a pose has ", pose.modifiers.size(), " weights of modifiers, the basis has ",
                count);
  }
  for (const float weight : pose.modifiers) {
    if (!std::isfinite(weight)) throw Error(ErrorKind::mismatch, "a modifier's weight is not a finite number");
  }
  append_padded(pose.modifiers, count, weights);
}

void check_controls(const Basis& basis, const Pose& pose) {
  const std::size_t controls = basis.residual.controls.size();
  if (!pose.controls.empty() && pose.controls.size() != controls) {
    throw Error(ErrorKind::mismatch, "a pose has ", pose.controls.size(), " control values, the basis has ", controls,
                " controls");
  }
  for (std::size_t c = 0; c < pose.controls.size(); ++c) {
    if (std::isfinite(pose.controls[c])) continue;
    throw Error(ErrorKind::mismatch, "the control '", basis.residual.controls[c], "' is not a finite number");
  }
}

// Their memory is used again.
void clear_all(auto&... values) { (values.clear(), ...); }

}  // namespace

// A call between its batches.
class RunningCall {
 public:
  explicit RunningCall(DeformerCall& call) : call_(call), deformer_(*call.deformer), memory_(*deformer_.memory_) {
    call_.error = nullptr;
    Evaluation& e = *call_.evaluation;
    clear_all(e.positions, e.normals, e.strains, e.outside, e.outside_feature, e.outside_by, e.excess, e.coordinates,
              e.fades, e.fading_joint, e.starts);
    e.stage_seconds = {};
    e.host_seconds = {};
    attempt([&] { check(); });
  }

  bool has_more() const { return !call_.error && begin_ < call_.poses.size(); }
  const DeformerCall& call() const { return call_; }

  // The next batch. Gives what is to run on the device before finish(); null: nothing, or it failed.
  vulkan::Commands* start() {
    vulkan::Commands* commands = nullptr;
    started_ = true;
    attempt([&] { commands = start_batch(); });
    return commands;
  }

  void finish() {
    if (!std::exchange(started_, false) || call_.error) return;
    attempt([&] {
      const Stopwatch watch;
      const BatchResult& result = split_ != nullptr ? split_->finish() : *result_;
      const double downloaded = watch.seconds();
      take(result, split_ != nullptr ? split_->skin() : SkinValues{result.positions, result.normals, result.tangents});
      host_seconds().download += downloaded;
      host_seconds().order += watch.seconds() - downloaded;
    });
  }

  HostSeconds& host_seconds() { return call_.evaluation->host_seconds; }

  // A batch that fails leaves the motion as it was. But of several batches some may have been stepped: for those the
  // motion was fetched from the device before the call.
  void fail(const std::exception_ptr& error) {
    call_.error = error;
    if (!has_before_) return;
    if (is_several_) {
      deformer_.set_state(memory_.before);
    } else {
      deformer_.state_ = memory_.before;
    }
  }

 private:
  template <typename Step>
  void attempt(const Step& step) {
    try {
      step();
    } catch (...) {
      fail(std::current_exception());
    }
  }

  void check() {
    if (call_.stays_on_device) deformer_.require_one_batch(call_.poses);
    if (wants_tangents()) deformer_.require_tangents();
    if (!call_.frames) return;
    if (!deformer_.jiggles_) {
      throw Error(ErrorKind::usage, "the character was loaded without dynamics: it cannot jiggle");
    }
    if (call_.frames->size() != call_.poses.size()) {
      throw Error(ErrorKind::usage, call_.poses.size(), " poses have ", call_.frames->size(), " frame numbers");
    }
    is_several_ = call_.poses.size() > deformer_.batch_limit();
    memory_.before = deformer_.state_;
    if (is_several_) memory_.before = deformer_.state();
    has_before_ = true;
  }

  bool wants_tangents() const { return call_.place != nullptr && call_.place->tangents.data != nullptr; }

  // As many as fit, and batches as long as each other: what was recorded for one then does for the next.
  std::size_t next_count() const {
    const std::size_t left = call_.poses.size() - begin_, limit = std::max(1u, deformer_.batch_limit());
    const std::size_t batches = (left + limit - 1) / limit;
    return (left + batches - 1) / batches;
  }

  vulkan::Commands* start_batch() {
    const std::size_t count = next_count();
    const Stopwatch watch;
    Batch& batch = make_batch(deformer_.basis(), call_.poses.subspan(begin_, count), memory_);
    batch.first_frame = begin_;
    batch.stays_on_device = call_.stays_on_device;
    batch.wants_normals = call_.place != nullptr ? call_.place->normals.data != nullptr : deformer_.wants_normals_;
    batch.wants_tangents = wants_tangents();
    if (call_.frames) deformer_.plan(call_.frames->subspan(begin_, count), batch);
    call_.evaluation->stage_seconds.add(Stage::rig, watch.seconds());
    const Stopwatch after_rig;
    split_ = deformer_.backend_->split();
    if (split_ != nullptr) {
      vulkan::Commands& commands = split_->start(batch);
      host_seconds().upload += after_rig.seconds();
      return &commands;
    }
    result_ = &deformer_.backend_->run(batch);
    host_seconds().wait += after_rig.seconds();
    return nullptr;
  }

  void take(const BatchResult& result, const SkinValues& skin) {
    const Basis& basis = deformer_.basis();
    Evaluation& evaluation = *call_.evaluation;
    const Batch& batch = memory_.batch;
    Executor& threads = deformer_.backend_->threads();
    if (call_.stays_on_device) {
      // The skin is where the device has it.
    } else if (call_.place != nullptr) {
      place_output(threads, basis.mesh, skin.positions, call_.place->positions, begin_);
      place_output(threads, basis.mesh, skin.normals, call_.place->normals, begin_);
      place_tangents(threads, skin.tangents, basis.mesh.output_count(), call_.place->tangents, begin_);
    } else {
      append_output(threads, basis.mesh, skin.positions, evaluation.positions);
      append_output(threads, basis.mesh, skin.normals, evaluation.normals);
    }
    evaluation.strains.insert(evaluation.strains.end(), result.strains.begin(), result.strains.end());
    evaluation.coordinates.insert(evaluation.coordinates.end(), result.coordinates.begin(), result.coordinates.end());
    append_outside(basis, memory_.rig.features(), result, batch.frame_count, evaluation);
    append_fades(basis, memory_, evaluation);
    for (const JiggleFrame& frame : batch.jiggle) evaluation.starts.push_back(frame.start);
    evaluation.stage_seconds.add(result.stage_seconds);
    begin_ += batch.frame_count;
  }

  DeformerCall& call_;
  Deformer& deformer_;
  CallMemory& memory_;
  bool has_before_ = false;  // of a jiggle
  bool is_several_ = false;  // batches
  bool started_ = false;     // and not finished
  std::size_t begin_ = 0;    // of the batch under way, in poses
  SplitRun* split_ = nullptr;
  const BatchResult* result_ = nullptr;  // the backend's, of a batch that nothing split
};

namespace {

// The calls whose work one device has.
struct Submission {
  std::vector<vulkan::Commands*> commands;
  std::vector<RunningCall*> calls;

  void run() const {
    const Stopwatch watch;
    try {
      vulkan::Commands::run_together(commands);
      calls.front()->host_seconds().wait += watch.seconds();
    } catch (...) {
      for (RunningCall* call : calls) call->fail(std::current_exception());
    }
  }
};

// A batch of every call that has more.
void run_batches(std::span<RunningCall> calls) {
  std::map<const vulkan::Device*, Submission> submissions;
  for (RunningCall& call : calls) {
    if (!call.has_more()) continue;
    vulkan::Commands* commands = call.start();
    if (commands == nullptr) continue;
    Submission& submission = submissions[&commands->device()];
    submission.commands.push_back(commands);
    submission.calls.push_back(&call);
  }
  for (const auto& [device, submission] : submissions) submission.run();
  for (RunningCall& call : calls) call.finish();
}

void run_all(std::span<RunningCall> calls) {
  while (std::ranges::any_of(calls, &RunningCall::has_more)) run_batches(calls);
}

}  // namespace

void evaluate_together(std::span<DeformerCall> calls) {
  if (calls.size() == 1) {
    RunningCall alone(calls.front());
    return run_all({&alone, 1});
  }
  std::vector<RunningCall> running;
  running.reserve(calls.size());
  for (DeformerCall& call : calls) {
    if (std::ranges::find(running, call.deformer, [](const RunningCall& r) { return r.call().deformer; }) !=
        running.end()) {
      throw Error(ErrorKind::usage, "an instance was asked for two evaluations at once");
    }
    running.emplace_back(call);
  }
  run_all(running);
}

Batch& make_batch(const Basis& basis, std::span<const Pose> poses, CallMemory& memory) {
  Batch& batch = memory.batch;
  clear_all(batch.skinning, batch.origins, batch.joint_features, batch.controls, batch.fades, batch.modifiers,
            batch.learned_skinning, batch.joints, batch.jiggle);
  batch.stays_on_device = batch.wants_tangents = false;
  batch.wants_normals = true;
  const RigFrame& rig = memory.frame;
  batch.frame_count = static_cast<std::uint32_t>(poses.size());
  const std::size_t regions = basis.residual.regions.size();
  for (const Pose& pose : poses) {
    memory.rig.pose(pose, memory.frame);
    batch.skinning.insert(batch.skinning.end(), rig.skinning.begin(), rig.skinning.end());
    batch.origins.insert(batch.origins.end(), {rig.origin[0], rig.origin[1], rig.origin[2], 0.0f});
    batch.joint_features.insert(batch.joint_features.end(), rig.joint_features.begin(), rig.joint_features.end());
    if (basis.modifiers.turn_joints()) {
      batch.learned_skinning.insert(batch.learned_skinning.end(), rig.learned_skinning.begin(),
                                    rig.learned_skinning.end());
    }
    batch.joints.insert(batch.joints.end(), rig.joints.begin(), rig.joints.end());
    memory.off = joints_off(basis.residual, rig.joint_features, std::move(memory.off));
    batch.fades.resize(batch.fades.size() + regions);
    region_fades(basis.residual, memory.off, std::span(batch.fades).last(regions));
    check_controls(basis, pose);
    append_padded(pose.controls, basis.residual.controls.size(), batch.controls);
    append_modifier_weights(basis, pose, batch.modifiers);
  }
  return batch;
}

}  // namespace bodyopt
