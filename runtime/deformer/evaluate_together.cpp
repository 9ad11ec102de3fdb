#include "runtime/deformer/evaluate_together.h"

#include <algorithm>
#include <cmath>
#include <cstring>
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
#include "shaders/include/layout.h"

namespace bodyopt {
namespace {

// Output vertices that a thread places at a time.
constexpr std::size_t kPartOutputs = 1024;

// F x V x 3 in runtime order into output order, frames `begin` and after.
void place_in_order(Executor& threads, const MeshTable& mesh, std::span<const float> values,
                    const PlacedVertices& place, std::size_t begin) {
  if (place.data == nullptr || values.empty()) return;
  const std::size_t numbers = 3 * std::size_t{mesh.vertex_count()};
  parallel_pieces(threads, values.size() / numbers, mesh.output_count(), kPartOutputs,
                  [&](std::size_t f, std::size_t first, std::size_t count) {
                    cpu::output_place(std::span(mesh.output_vertex).subspan(first, count),
                                      values.subspan(f * numbers, numbers), place.element_stride,
                                      place.data + (begin + f) * place.frame_stride + first * place.element_stride);
                  });
}

// F x O x `numbers` in output order, frames `begin` and after.
void place_ordered(Executor& threads, std::size_t outputs, std::size_t numbers, std::span<const float> values,
                   const PlacedVertices& place, std::size_t begin) {
  if (place.data == nullptr || values.empty()) return;
  const std::size_t bytes = numbers * sizeof(float);
  parallel_pieces(threads, values.size() / (numbers * outputs), outputs, kPartOutputs,
                  [&](std::size_t f, std::size_t first, std::size_t count) {
                    const float* from = &values[numbers * (f * outputs + first)];
                    std::byte* to = place.data + (begin + f) * place.frame_stride + first * place.element_stride;
                    if (place.element_stride == bytes) {
                      std::memcpy(to, from, count * bytes);
                      return;
                    }
                    for (std::size_t o = 0; o < count; ++o, from += numbers, to += place.element_stride) {
                      std::memcpy(to, from, bytes);
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

void append_fades(const Basis& basis, const Batch& batch, CallMemory& memory, Evaluation& evaluation) {
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

// A call between its batches: of a device two may be under way.
class RunningCall {
 public:
  explicit RunningCall(DeformerCall& call) : call_(call), deformer_(*call.deformer), memory_(*deformer_.memory_) {
    call_.error = nullptr;
    Evaluation& e = *call_.evaluation;
    clear_all(e.strains, e.outside, e.outside_feature, e.outside_by, e.excess, e.coordinates, e.fades, e.fading_joint,
              e.starts);
    e.stage_seconds = {};
    e.host_seconds = {};
    attempt([&] {
      make_place();
      check();
    });
  }

  bool has_more() const { return !call_.error && begin_ < call_.poses.size(); }
  bool is_under_way() const { return first_ != nullptr; }
  const DeformerCall& call() const { return call_; }

  // Starts the next batch. Gives what is to run on the device before finish(); null: nothing, or it failed.
  vulkan::Commands* start() {
    vulkan::Commands* commands = nullptr;
    attempt([&] { commands = start_batch(); });
    return commands;
  }

  // Finishes the batch that was started first, whether or not the call has failed since.
  void finish() {
    if (first_ == nullptr) return;
    const Batch& batch = *std::exchange(first_, std::exchange(second_, nullptr));
    attempt([&] {
      const Stopwatch watch;
      SplitRun* const split = deformer_.backend_->split();
      if (split == nullptr && call_.error) return;
      const BatchResult& result = split != nullptr ? split->finish() : deformer_.backend_->run(batch);
      has_run_ = true;
      (split != nullptr ? host_seconds().download : host_seconds().wait) += watch.seconds();
      if (call_.error) return;
      const Stopwatch after_run;
      if (split != nullptr) {
        place_fetched(split->skin(), batch.first_frame);
      } else {
        place_run(result, batch.first_frame);
      }
      tell(result, batch);
      host_seconds().order += after_run.seconds();
    });
  }

  HostSeconds& host_seconds() { return call_.evaluation->host_seconds; }

  // The first error is kept.
  void fail(const std::exception_ptr& error) {
    if (!call_.error) call_.error = error;
  }

  // Once nothing is under way. A batch that failed left the motion as it was. But of several batches some may have been
  // stepped: for those the motion was fetched from the device before the call. Of one that was stepped before something
  // else failed the motion is lost, and starts anew.
  void end() {
    if (!call_.error || !has_before_) return;
    attempt([&] {
      if (is_several_) {
        deformer_.set_state(memory_.before);
      } else {
        deformer_.state_ = has_run_ ? JiggleState() : memory_.before;
      }
    });
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

  // The skin goes to the caller's place, or into the evaluation.
  void make_place() {
    Evaluation& e = *call_.evaluation;
    const bool is_here = !call_.stays_on_device && call_.place == nullptr;
    const std::size_t frame = is_here ? 3 * std::size_t{deformer_.basis().mesh.output_count()} : 0;
    e.positions.resize(call_.poses.size() * frame);
    e.normals.resize(deformer_.wants_normals_ ? e.positions.size() : 0);
    const auto in = [&](std::vector<float>& values) {
      return PlacedVertices{reinterpret_cast<std::byte*>(values.data()), 3 * sizeof(float), frame * sizeof(float)};
    };
    if (is_here) {
      place_ = {.positions = in(e.positions), .normals = e.normals.empty() ? PlacedVertices() : in(e.normals)};
    } else if (!call_.stays_on_device) {
      place_ = *call_.place;
    }
  }

  void check() {
    if (is_whole()) deformer_.require_one_batch(call_.poses);
    if (wants_tangents()) deformer_.require_tangents();
    if (!call_.frames) return;
    if (!deformer_.jiggles_) {
      throw Error(ErrorKind::usage, "the character was loaded without dynamics: it cannot jiggle");
    }
    if (call_.frames->size() != call_.poses.size()) {
      throw Error(ErrorKind::usage, call_.poses.size(), " poses have ", call_.frames->size(), " frame numbers");
    }
    is_several_ = next_count() < call_.poses.size();
    memory_.before = deformer_.state_;
    if (is_several_) memory_.before = deformer_.state();
    has_before_ = true;
  }

  bool wants_tangents() const { return place_.tangents.data != nullptr; }

  bool is_whole() const { return call_.stays_on_device || call_.is_one_batch; }

  // As many as fit, and batches as long as each other: what was recorded for one then does for the next. Kernels run
  // some frames together: a batch has a multiple of them.
  std::size_t next_count() const {
    if (is_whole()) return call_.poses.size();
    const std::size_t left = call_.poses.size() - begin_, limit = std::max(1u, deformer_.batch_limit());
    const std::size_t batches = (left + limit - 1) / limit, even = batches == 0 ? 0 : (left + batches - 1) / batches;
    return std::min({left, limit, (even + kFramesTogether - 1) / kFramesTogether * kFramesTogether});
  }

  vulkan::Commands* start_batch() {
    const std::size_t count = next_count();
    const Stopwatch watch;
    const std::size_t free = first_ == memory_.batches.data() ? 1 : 0;
    Batch& batch = make_batch(deformer_.basis(), call_.poses.subspan(begin_, count), memory_, free);
    batch.first_frame = begin_;
    batch.stays_on_device = call_.stays_on_device;
    batch.wants_normals = call_.stays_on_device ? deformer_.wants_normals_ : place_.normals.data != nullptr;
    batch.wants_tangents = wants_tangents();
    if (call_.frames) deformer_.plan(call_.frames->subspan(begin_, count), batch);
    call_.evaluation->stage_seconds.add(Stage::rig, watch.seconds());
    begin_ += count;
    SplitRun* const split = deformer_.backend_->split();
    const Stopwatch after_rig;
    vulkan::Commands* const commands = split != nullptr ? &split->start(batch) : nullptr;
    if (split != nullptr) host_seconds().upload += after_rig.seconds();
    (first_ == nullptr ? first_ : second_) = &batch;
    return commands;
  }

  Executor& threads() const { return deformer_.backend_->threads(); }

  // What a device gave is in output order.
  void place_fetched(const SkinValues& skin, std::size_t begin) const {
    const std::size_t outputs = deformer_.basis().mesh.output_count();
    place_ordered(threads(), outputs, 3, skin.positions, place_.positions, begin);
    place_ordered(threads(), outputs, 3, skin.normals, place_.normals, begin);
    place_ordered(threads(), outputs, 4, skin.tangents, place_.tangents, begin);
  }

  void place_run(const BatchResult& result, std::size_t begin) const {
    const MeshTable& mesh = deformer_.basis().mesh;
    place_in_order(threads(), mesh, result.positions, place_.positions, begin);
    place_in_order(threads(), mesh, result.normals, place_.normals, begin);
    place_ordered(threads(), mesh.output_count(), 4, result.tangents, place_.tangents, begin);
  }

  // All but the skin.
  void tell(const BatchResult& result, const Batch& batch) {
    const Basis& basis = deformer_.basis();
    Evaluation& evaluation = *call_.evaluation;
    evaluation.strains.insert(evaluation.strains.end(), result.strains.begin(), result.strains.end());
    evaluation.coordinates.insert(evaluation.coordinates.end(), result.coordinates.begin(), result.coordinates.end());
    append_outside(basis, memory_.rig.features(), result, batch.frame_count, evaluation);
    append_fades(basis, batch, memory_, evaluation);
    for (const JiggleFrame& frame : batch.jiggle) evaluation.starts.push_back(frame.start);
    evaluation.stage_seconds.add(result.stage_seconds);
  }

  DeformerCall& call_;
  Deformer& deformer_;
  CallMemory& memory_;
  SkinPlace place_{};
  bool has_before_ = false;                           // of a jiggle
  bool is_several_ = false;                           // batches
  bool has_run_ = false;                              // one of them
  std::size_t begin_ = 0;                             // of the next batch, in poses
  const Batch *first_ = nullptr, *second_ = nullptr;  // under way
};

namespace {

// Batches that one device runs together.
struct Submission {
  std::vector<vulkan::Commands*> commands;
  std::vector<RunningCall*> calls;

  template <typename Step>
  void attempt(const Step& step) const {
    try {
      step();
    } catch (...) {
      for (RunningCall* call : calls) call->fail(std::current_exception());
    }
  }

  void submit() const {
    attempt([&] { vulkan::Commands::submit_together(commands); });
  }

  void wait() const {
    const Stopwatch watch;
    attempt([&] { vulkan::Commands::wait_together(commands); });
    calls.front()->host_seconds().wait += watch.seconds();
  }
};

// A batch of each call that has more.
std::vector<Submission> start_round(std::span<RunningCall> calls) {
  std::vector<Submission> submissions;
  for (RunningCall& call : calls) {
    vulkan::Commands* const commands = call.has_more() ? call.start() : nullptr;
    if (commands == nullptr) continue;
    const auto is_its = [&](const Submission& s) { return &s.commands.front()->device() == &commands->device(); };
    auto submission = std::ranges::find_if(submissions, is_its);
    if (submission == submissions.end()) submission = submissions.emplace(submission);
    submission->commands.push_back(commands);
    submission->calls.push_back(&call);
  }
  for (const Submission& submission : submissions) submission.submit();
  return submissions;
}

// Devices run a round while the next is prepared and the one before is taken.
void run_all(std::span<RunningCall> calls) {
  std::vector<Submission> running = start_round(calls);
  while (std::ranges::any_of(calls, &RunningCall::is_under_way)) {
    std::vector<Submission> next = start_round(calls);
    for (const Submission& submission : running) submission.wait();
    for (RunningCall& call : calls) call.finish();
    running = std::move(next);
  }
  for (RunningCall& call : calls) call.end();
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

Batch& make_batch(const Basis& basis, std::span<const Pose> poses, CallMemory& memory, std::size_t which) {
  Batch& batch = memory.batches[which];
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
